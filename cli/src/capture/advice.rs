//! Describes each remedy as a command-line option.

use stepscope_core::inspect::recording::remedy::{Note, Remedy};
use stepscope_core::inspect::recording::report::LineReport;

pub(super) fn option(remedy: &Remedy) -> String {
    match remedy {
        Remedy::BothEdges { motor, channel } => {
            format!("; for such a driver use --both-edges, or DEDGE{motor}={channel} in the map")
        }
        Remedy::OtherEdge { motor, channel, inverted } => {
            let mark = if *inverted { "!" } else { "" };
            format!(
                "; if the driver steps at the start of a pulse, use STEP{motor}={mark}{channel} in the map"
            )
        }
        Remedy::InvertLine { line, inverted: true } => format!(": map it with !, such as {line}=!CH1"),
        Remedy::InvertLine { line, inverted: false } => format!(": map it without !, such as {line}=CH1"),
        Remedy::ChooseLine => "; choose one with a map, such as RX=#0".to_owned(),
        Remedy::Format(format) => format!(": try --uart {format}"),
        Remedy::Baud => "; use --baud".to_owned(),
        Remedy::BaudOrFormat => "; use --baud for the bit rate, or --uart for the format".to_owned(),
    }
}

pub(super) fn note(Note { text, remedy }: &Note) -> String {
    text.clone() + &remedy.as_ref().map(option).unwrap_or_default()
}

pub(super) fn line(line: &LineReport) -> String {
    of_line(&line.to_text(), line)
}

pub(super) fn of_line(text: &str, line: &LineReport) -> String {
    text.to_owned() + &line.remedies.iter().map(option).collect::<String>()
}
