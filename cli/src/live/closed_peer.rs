//! Whether the program at the other end of a local connection has closed it, while bytes that it sent still wait in the system.
//!
//! TCP itself shows that only when those bytes are read: the end comes behind them. A server that reads no faster than a serial line
//! would serve nobody else for minutes.

use std::net::SocketAddr;

/// Whether nobody has the socket `there` open any more, which was connected to `here`. False where the system does not tell: of
/// other machines, and on other systems than Linux.
pub(super) fn is_closed(here: SocketAddr, there: SocketAddr) -> bool {
    if !cfg!(target_os = "linux") || !there.ip().is_loopback() {
        return false;
    }
    let table = if there.is_ipv4() { "/proc/net/tcp" } else { "/proc/net/tcp6" };
    std::fs::read_to_string(table).is_ok_and(|table| is_closed_in(&table, there.port(), here.port()))
}

/// Whether a table of sockets has none between two ports that belongs to somebody: what is left of a closed one has no inode.
fn is_closed_in(table: &str, from: u16, to: u16) -> bool {
    let port = |address: &str| u16::from_str_radix(address.rsplit(':').next()?, 16).ok();
    !table.lines().skip(1).any(|row| {
        let mut columns = row.split_whitespace();
        let (local, remote, inode) = (columns.nth(1), columns.next(), columns.nth(6));
        let is_it = local.and_then(port) == Some(from) && remote.and_then(port) == Some(to);
        is_it && inode != Some("0")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_socket_is_closed_when_it_is_nobody_s_or_not_in_the_table() {
        let table = "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode
   0: 0100007F:1267 0100007F:B0A2 01 00000000:00000000 00:00000000 00000000     0        0 4242 1 0 20 4 30 10 -1
   1: 0100007F:B0A2 0100007F:1267 01 00000000:00000000 00:00000000 00000000     0        0 4243 1 0 20 4 30 10 -1
   2: 0100007F:B0A4 0100007F:1267 04 00280000:00000000 04:00000010 00000000     0        0 0 2 0
";
        for (from, closed) in [(0xb0a2, false), (0xb0a4, true), (0xb0a6, true)] {
            assert_eq!(is_closed_in(table, from, 0x1267), closed, "{from:x}");
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_client_that_closed_is_seen_behind_bytes_that_nobody_reads() {
        use std::{
            io::Write as _,
            net::{Shutdown, TcpListener, TcpStream},
        };
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let here = listener.local_addr().expect("an address");
        let mut client = TcpStream::connect(here).expect("it listens");
        let (server, there) = listener.accept().expect("a client");
        client.set_nonblocking(true).expect("it can be");
        while matches!(client.write(&[0; 1 << 16]), Ok(1..)) {}
        assert!(!is_closed(here, there));
        // One that only sends no more may still read.
        client.shutdown(Shutdown::Write).expect("it is open");
        assert!(!is_closed(here, there));
        drop(client);
        assert!(is_closed(here, there));
        drop(server);
    }
}
