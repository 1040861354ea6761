//! External names and values must not control the terminal.

use crate::program::stepscope;
use std::{fs, path::PathBuf};

/// Erases the screen, sets a title, reverses the text, ends the line.
const HOSTILE: &str = "x\u{1b}[2J\u{1b}]0;t\u{7}\u{9b}31m\u{202e}y\u{7f}";

fn json() -> String {
    HOSTILE.chars().map(|c| format!("\\u{:04x}", u32::from(c))).collect()
}

fn assert_safe(what: &str, text: &str) {
    let is_safe =
        |c: char| !c.is_control() && !matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    assert!(text.chars().all(|c| is_safe(c) || c == '\n'), "{what}: {text:?}");
}

#[test]
fn escapes_control_characters_in_every_message() {
    let json = json();
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("terminal");
    fs::create_dir_all(&folder).expect("a folder");
    let named = folder.join(HOSTILE);
    fs::write(&named, "{").expect("a file");
    let named = named.display().to_string();
    let missing = format!("{HOSTILE}.json");
    let field = format!(r#"{{"{json}":1,"bus":{{"pulses":"{json}","channels":"{json}"}}}}"#);
    let title = format!(r#"{{"title":"{json}","note":"{json}"}}"#);
    let table = format!("length_mm,steps\n{HOSTILE},1\n");
    let steps = format!("cycle,dir\n1,{HOSTILE}\n");
    let head = format!("{HOSTILE},b\n1,2\n");
    let dump = format!(
        "$timescale 1 us $end\n$var wire 1 ! {HOSTILE} $end\n$enddefinitions $end\n#0\n0!\n#5\n1!\n#9\n0!\n"
    );
    let analyzer = format!("Time [s],{HOSTILE}\n0.0,0\n0.001,1\n0.002,0\n");
    let calls: &[(&[&str], &str)] = &[
        (&["run", &missing], ""),
        (&["run", &named], ""),
        (&["run", "-"], &field),
        (&["run", "-", "--trace", &named, "--csv", &named], "{}"),
        (&["run", "-", "--driver", HOSTILE], "{}"),
        (&["run", "-", HOSTILE], "{}"),
        (&[HOSTILE], ""),
        (&["run", "-", "--line", "-"], &title),
        (&["tables", "-", "--format", "c"], &title),
        (&["tables", "--steps", "-"], &steps),
        (&["tables", "--steps", "-"], &head),
        (&["calibrate", "-"], &table),
        (&["points", "-"], &table),
        (&["presets", HOSTILE], ""),
        (&["open", HOSTILE], ""),
        (&["torque", "-", "--motor", HOSTILE], "{}"),
        (&["capture", &missing], ""),
        (&["capture", "-"], &dump),
        (&["capture", "-", "--json"], &dump),
        (&["capture", "-"], &analyzer),
        (&["capture", "-", "--map", HOSTILE], &dump),
        (&["capture", "-"], &head),
        (&["send", "-", "--port", HOSTILE], "{}"),
        (&["serve", &missing, "--tcp", "127.0.0.1:0"], ""),
    ];
    for (arguments, input) in calls {
        let (_, out, err) = stepscope(arguments, input);
        assert!(!out.is_empty() || !err.is_empty(), "{arguments:?}");
        assert_safe(&format!("{arguments:?}"), &(out + &err));
    }
    let (code, out, _) = stepscope(&["run", "-", "--line", "-"], &title);
    let expected = stepscope(&["run", "-", "--digest"], &title).1;
    assert_eq!((code, stepscope(&["run", "-", "--digest"], &out).1), (Some(0), expected));
}

/// Text goes through `cli/src/terminal.rs`; exceptions are listed here.
#[test]
fn all_text_is_printed_by_the_escaping_writer() {
    fn sources(folder: &PathBuf, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            if entry.is_dir() {
                sources(&entry, found);
            } else {
                found.push(entry);
            }
        }
    }
    // The writer itself, data in place of a file, lines that overwrite each other, the manual, escaped JSON, clap's
    // help.
    let known = [
        "terminal.rs",
        "json.rs",
        "output.rs",
        "progress.rs",
        "status_line.rs",
        "manual.rs",
        "scenario_file.rs",
        "main.rs",
    ];
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut all = Vec::new();
    sources(&root, &mut all);
    assert!(all.len() > 40, "{all:?}");
    for path in all {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).expect("a source");
        let raw = ["io::stdout()", "io::stderr()", "print!(", "println!("];
        let raw = raw.iter().filter(|word| text.replace("io::stderr().is_terminal()", "").contains(*word));
        let found: Vec<_> = raw.collect();
        assert!(found.is_empty() || known.contains(&name.as_str()), "{}: {found:?}", path.display());
    }
}
