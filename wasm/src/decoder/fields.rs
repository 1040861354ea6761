//! The fields of a packet or frame, each over the bytes that carry it (DESIGN A5, A6).

use super::{Placed, Span};
use crate::simulation::Simulation;
use stepscope_core::{
    protocol::{FrameFate, Kind, Reason, State},
    scenario::Protocol,
    trace::Verdict,
    wire::packet::{ALL, Order},
};

/// Bytes of a frame's check.
const CHECK_LEN: usize = 4;
/// Set in the kind of a frame that acknowledges.
const ACK: u8 = 0x80;
/// Kind of a frame that refuses.
const NAK: u8 = 0xff;

/// Spans of one packet as they are found.
struct Fields {
    packet: usize,
    spans: Vec<Span>,
}

impl Fields {
    /// A field over these bytes.
    fn add<const N: usize>(&mut self, bytes: &[Placed], texts: [String; N], bad: bool) {
        let (Some(first), Some(last)) = (bytes.first(), bytes.last()) else { return };
        let span = Span {
            start: first.start,
            end: last.end,
            texts: texts.into(),
            bad,
            packet: Some(self.packet),
            sample: None,
        };
        self.spans.push(span);
    }

    /// One byte that orders steps.
    fn order(&mut self, bytes: &[Placed], channel: usize) {
        let Some(byte) = bytes.first() else { return };
        let Order { right, steps } = Order::parse(byte.byte);
        let sign = if steps == 0 {
            ""
        } else if right {
            "+"
        } else {
            "\u{2212}"
        };
        let texts = [
            format!("ch {channel}: {sign}{steps} steps"),
            format!("ch{channel} {sign}{steps}"),
            format!("{sign}{steps}"),
        ];
        self.add(bytes, texts, false);
    }

    fn address(&mut self, bytes: &[Placed]) {
        let Some(byte) = bytes.first() else { return };
        let name = if byte.byte == ALL { "all".to_owned() } else { byte.byte.to_string() };
        self.add(bytes, [format!("address {name}"), name], false);
    }
}

impl Simulation {
    /// The fields of a row of the packets.
    pub(super) fn fields_of(&self, packet: usize) -> Vec<Span> {
        let Some(row) = self.looked_at().recording.packets.rows().get(packet) else { return Vec::new() };
        let bytes = self.placed(packet);
        let mut fields = Fields { packet, spans: Vec::new() };
        let whole = |text: &str| [text.to_owned(), "!".to_owned()];
        match row.verdict {
            Verdict::Ignored => fields.add(&bytes, whole("ignored until a gap"), true),
            Verdict::Frame(FrameFate::Short) => {
                fields.add(&bytes, whole("no frame: too short, or not COBS"), true)
            }
            Verdict::Frame(FrameFate::Overlong) => fields.add(&bytes, whole("too long for a frame"), true),
            Verdict::Collision => {}
            Verdict::Open if self.own().protocol() == Protocol::Framed => {
                fields.add(&bytes, ["not complete".into()], false)
            }
            Verdict::Frame(_) | Verdict::Reply(_) => self.frame(&bytes, row.verdict, &mut fields),
            Verdict::Packet(_) | Verdict::Short | Verdict::Framing | Verdict::Open => {
                let orders = if self.own().packet_address().is_some() {
                    fields.address(bytes.get(..1).unwrap_or_default());
                    bytes.get(1..).unwrap_or_default()
                } else {
                    &bytes
                };
                for (channel, byte) in orders.chunks(1).enumerate() {
                    fields.order(byte, channel);
                }
                if let (Verdict::Short, Some(last)) = (row.verdict, bytes.last()) {
                    let gap = Placed { start: last.end, end: row.end.0.max(last.end), ..*last };
                    let texts = ["SHORT_PACKET: cut by a gap".into(), "SHORT_PACKET".into(), "!".into()];
                    fields.add(&[gap], texts, true);
                }
            }
        }
        fields.spans
    }

    /// The fields of a frame that could be decoded, whether its check holds or not.
    fn frame(&self, wire: &[Placed], verdict: Verdict, fields: &mut Fields) {
        let content = unstuffed(wire);
        let (head, check) = content.split_at(content.len().saturating_sub(CHECK_LEN));
        let [address, kind, body @ ..] = head else { return };
        let named = |byte: u8| match byte {
            NAK => "NAK".to_owned(),
            byte if byte & ACK != 0 => format!("ACK of {}", Kind::parse(byte & !ACK).map_or("?", Kind::name)),
            byte => Kind::parse(byte).map_or_else(|| format!("{byte:#04x}"), |kind| kind.name().to_owned()),
        };
        fields.address(&[*address]);
        let name = named(kind.byte);
        fields.add(&[*kind], [format!("kind {name}"), name, format!("{:02x}", kind.byte)], false);
        match kind.byte {
            byte if byte == Kind::Ticks as u8 => self.ticks(address.byte, body, fields),
            NAK => {
                let (reason, rest) = body.split_at(body.len().min(1));
                if let [reason] = reason {
                    let name = Reason::parse(reason.byte).map_or("?", Reason::name);
                    fields.add(&[*reason], [format!("reason {name}"), name.to_owned(), "!".into()], true);
                }
                status(rest, fields);
            }
            byte if byte & ACK != 0 => status(body, fields),
            _ => fields.add(body, ["body".into()], true),
        }
        let found = little_endian(check);
        match verdict {
            Verdict::Frame(FrameFate::BadCheck { expected, .. }) => fields.add(
                check,
                [
                    format!("CRC {found:08x}, {expected:08x} expected"),
                    format!("CRC {found:08x}!"),
                    "CRC!".into(),
                    "!".into(),
                ],
                true,
            ),
            _ => {
                fields.add(check, [format!("CRC {found:08x} holds"), "CRC holds".into(), "CRC".into()], false)
            }
        }
        if let Some(end) = wire.last().filter(|last| last.byte == 0) {
            fields.add(&[*end], ["end mark".into(), "end".into()], false);
        }
    }

    fn ticks(&self, address: u8, body: &[Placed], fields: &mut Fields) {
        let [seq, count, orders @ ..] = body else { return };
        fields.add(&[*seq], [format!("seq {}", seq.byte), seq.byte.to_string()], false);
        let many = if count.byte == 1 { "tick" } else { "ticks" };
        fields.add(&[*count], [format!("{} {many}", count.byte), count.byte.to_string()], false);
        let addressed = self.experiment.configs().find(|config| config.address() == Some(address));
        let channels = usize::from(addressed.unwrap_or(self.own()).channels());
        for (index, byte) in orders.chunks(1).enumerate() {
            fields.order(byte, index % channels.max(1));
        }
    }
}

/// The status that a reply ends with.
fn status(body: &[Placed], fields: &mut Fields) {
    let &[state, free, seq, ref rest @ ..] = body else { return };
    let name = State::parse(state.byte).map_or("?", State::name);
    fields.add(&[state], [format!("state {name}"), name.to_owned()], false);
    fields.add(
        &[free],
        [format!("{} places free", free.byte), format!("{} free", free.byte), free.byte.to_string()],
        false,
    );
    fields.add(
        &[seq],
        [format!("expects seq {}", seq.byte), format!("seq {}", seq.byte), seq.byte.to_string()],
        false,
    );
    let (faults, done) = rest.split_at(rest.len().min(2));
    let flags = little_endian(faults);
    fields.add(faults, [format!("faults {flags:04x}"), format!("{flags:04x}")], false);
    let ticks = little_endian(done);
    fields.add(done, [format!("{ticks} ticks done"), ticks.to_string()], false);
}

fn little_endian(bytes: &[Placed]) -> u32 {
    bytes.iter().rev().fold(0, |value, byte| value << 8 | u32::from(byte.byte))
}

/// What COBS carries, each byte where it lies on the wire: a zero where the code stands that owes it.
fn unstuffed(wire: &[Placed]) -> Vec<Placed> {
    let mut content = Vec::new();
    let mut at = wire.iter().take_while(|byte| byte.byte == 0).count();
    while let Some(code) = wire.get(at).map(|byte| byte.byte).filter(|&code| code != 0) {
        let next = at + usize::from(code);
        content.extend_from_slice(wire.get(at + 1..next.min(wire.len())).unwrap_or_default());
        // A full block owes none, nor does the last one.
        if let Some(zero) = wire.get(next).filter(|after| code != u8::MAX && after.byte != 0) {
            content.push(Placed { byte: 0, ..*zero });
        }
        at = next;
    }
    content
}

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_core::wire::frame::{Deframed, Deframer, Frame, emit};

    #[test]
    fn what_cobs_carries_is_what_the_controller_reads() {
        for body in [&[0_u8, 0, 1, 0][..], &[7; 300], &[0; 300], &[]] {
            let wire = emit(5, 1, body);
            let placed: Vec<Placed> = wire
                .iter()
                .enumerate()
                .map(|(index, &byte)| Placed { packet: 0, byte, start: index as u64, end: index as u64 + 1 })
                .collect();
            let content: Vec<u8> = unstuffed(&placed).iter().map(|byte| byte.byte).collect();
            let mut deframer = Deframer::default();
            let read = wire.iter().find_map(|&byte| match deframer.byte(byte) {
                Some(Deframed::Frame(Frame { address, kind, body })) => {
                    Some([&[address, kind], body].concat())
                }
                _ => None,
            });
            assert_eq!(Some(content[..content.len() - CHECK_LEN].to_vec()), read);
        }
    }
}
