//! Detects that a local program has closed its connection while its bytes are still unread.
//!
//! TCP shows this only when the bytes have been read. A server that reads at the speed of a serial line would be
//! blocked for minutes.

use std::{io, net::SocketAddr};

/// Whether the process of socket `there`, connected to `here`, has closed it. False for other machines, and on
/// systems other than Linux.
pub(super) fn is_closed(here: SocketAddr, there: SocketAddr) -> bool {
    if !cfg!(target_os = "linux") || !there.ip().to_canonical().is_loopback() {
        return false;
    }
    // An IPv6 socket may be connected to an IPv4 address, so either table may have the row.
    let tables = ["/proc/net/tcp", "/proc/net/tcp6"].map(read);
    tables
        .into_iter()
        .collect::<io::Result<String>>()
        .is_ok_and(|rows| is_closed_in(&rows, there.port(), here.port()))
}

/// Empty on a system without this address family.
fn read(table: &str) -> io::Result<String> {
    match std::fs::read_to_string(table) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(String::new()),
        rows => rows,
    }
}

/// Whether all rows between the ports have no inode, as for closed sockets. No row means unknown: tables are not read
/// atomically.
fn is_closed_in(rows: &str, from: u16, to: u16) -> bool {
    let port = |address: &str| u16::from_str_radix(address.rsplit(':').next()?, 16).ok();
    let mut inodes = rows
        .lines()
        .filter_map(|row| {
            let mut columns = row.split_whitespace();
            let (local, remote, inode) = (columns.nth(1)?, columns.next()?, columns.nth(6)?);
            (port(local) == Some(from) && port(remote) == Some(to)).then_some(inode)
        })
        .peekable();
    inodes.peek().is_some() && inodes.all(|inode| inode == "0")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_socket_without_inode_is_closed() {
        let rows = "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode
   0: 0100007F:1267 0100007F:B0A2 01 00000000:00000000 00:00000000 00000000     0        0 4242 1 0 20 4 30 10 -1
   1: 0100007F:B0A2 0100007F:1267 01 00000000:00000000 00:00000000 00000000     0        0 4243 1 0 20 4 30 10 -1
   2: 0100007F:B0A4 0100007F:1267 04 00280000:00000000 04:00000010 00000000     0        0 0 2 0
   3: 0200007F:B0A2 0200007F:1267 06 00000000:00000000 03:00000010 00000000     0        0 0 3 0
  sl  local_address                         remote_address                        st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode
   0: 0000000000000000FFFF00000100007F:B0A8 0000000000000000FFFF00000100007F:1267 01 00000000:00000000 00:00000000 00000000     0        0 4244 1 0 20 4 30 10 -1
   1: 0000000000000000FFFF00000100007F:B0AA 0000000000000000FFFF00000100007F:1267 05 00000000:00000000 00:00000000 00000000     0        0 0 1 0 20 4 30 10 -1
";
        for (from, closed) in
            [(0xb0a2, false), (0xb0a4, true), (0xb0a6, false), (0xb0a8, false), (0xb0aa, true)]
        {
            assert_eq!(is_closed_in(rows, from, 0x1267), closed, "{from:x}");
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn detects_a_closed_client_behind_unread_bytes() {
        use std::{
            io::Write as _,
            net::{Shutdown, TcpListener, TcpStream},
        };
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let here = listener.local_addr().expect("an address");
        // The second one is an IPv6 socket.
        let mapped: SocketAddr = format!("[::ffff:127.0.0.1]:{}", here.port()).parse().expect("an address");
        for address in [here, mapped] {
            let mut client = match TcpStream::connect(address) {
                Ok(client) => client,
                // A system without IPv6.
                Err(_) if address == mapped => continue,
                Err(error) => panic!("{error}"),
            };
            let (server, there) = listener.accept().expect("a client");
            client.set_nonblocking(true).expect("it can be");
            while matches!(client.write(&[0; 1 << 16]), Ok(1..)) {}
            assert!(!is_closed(here, there), "{address}");
            // A client that has only stopped sending may still read.
            client.shutdown(Shutdown::Write).expect("it is open");
            assert!(!is_closed(here, there), "{address}");
            drop(client);
            // Rows change while the tables are read.
            while !is_closed(here, there) {}
            drop(server);
        }
    }
}
