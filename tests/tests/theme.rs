//! Contrasts of the page's colors (WCAG 1.4.3 and 1.4.11), computed from `web/style/theme.css`.

use std::{collections::BTreeMap, fs, path::Path};

type Colors = BTreeMap<String, [u8; 3]>;

fn theme() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../web/style/theme.css");
    fs::read_to_string(path).expect("the theme is there")
}

/// The custom properties whose colors the rule with this selector sets.
fn colors(css: &str, selector: &str) -> Colors {
    let (_, rest) = css.split_once(&format!("{selector} {{")).unwrap_or_else(|| panic!("no rule {selector}"));
    let (block, _) = rest.split_once('}').expect("the rule ends");
    let declared = block.split(';').filter_map(|line| line.trim().strip_prefix("--")?.split_once(": #"));
    declared
        .filter_map(|(name, hex)| {
            let value = u32::from_str_radix(hex.trim(), 16).ok().filter(|_| hex.trim().len() == 6)?;
            let [_, red, green, blue] = value.to_be_bytes();
            Some((name.to_owned(), [red, green, blue]))
        })
        .collect()
}

fn light() -> Colors {
    colors(&theme(), ":root")
}

fn dark() -> Colors {
    colors(&theme(), ":root[data-theme=\"dark\"]")
}

/// Relative luminance, 0 to 1.
fn luminance(color: [u8; 3]) -> f64 {
    let [red, green, blue] = color.map(|part| {
        let part = f64::from(part) / 255.0;
        if part <= 0.04045 { part / 12.92 } else { libm::pow((part + 0.055) / 1.055, 2.4) }
    });
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

/// 1 for equal colors to 21 for black on white.
fn contrast(one: [u8; 3], other: [u8; 3]) -> f64 {
    let (one, other) = (luminance(one), luminance(other));
    (one.max(other) + 0.05) / (one.min(other) + 0.05)
}

/// Fails with all pairs of these colors and backgrounds that have a lower contrast.
fn at_least(least: f64, names: &[&str], grounds: &[&str]) {
    let mut low = Vec::new();
    for (theme, colors) in [("light", light()), ("dark", dark())] {
        let of = |name: &str| *colors.get(name).unwrap_or_else(|| panic!("{theme} has no --{name}"));
        for (name, ground) in names.iter().flat_map(|name| grounds.iter().map(move |ground| (name, ground))) {
            let ratio = contrast(of(name), of(ground));
            if ratio < least {
                low.push(format!("{theme}: --{name} on --{ground} has {ratio:.2}, not {least}"));
            }
        }
    }
    assert!(low.is_empty(), "{}", low.join("\n"));
}

#[test]
fn contrasts_of_known_colors_match_the_standard() {
    for (one, other, expected) in [
        ([0, 0, 0], [255, 255, 255], 21.0),
        ([0x76, 0x76, 0x76], [255, 255, 255], 4.54),
        ([0x12, 0x34, 0x56], [0x12, 0x34, 0x56], 1.0),
    ] {
        assert!((contrast(one, other) - expected).abs() < 0.005, "{one:?} on {other:?}");
    }
}

#[test]
fn both_selectors_of_dark_mode_have_the_same_colors() {
    assert_eq!(colors(&theme(), ":root:not([data-theme=\"light\"])"), dark());
    assert_eq!(light().keys().collect::<Vec<_>>(), dark().keys().collect::<Vec<_>>());
}

#[test]
fn text_has_a_contrast_of_at_least_4_5() {
    at_least(4.5, &["ink", "quiet"], &["pane", "ground", "raised", "chosen"]);
    at_least(4.5, &["ink", "error"], &["pane", "error-ground"]);
    at_least(4.5, &["ink", "warning"], &["pane", "warning-ground"]);
    at_least(4.5, &["ink"], &["info-ground"]);
    at_least(4.5, &["on-accent"], &["accent"]);
}

#[test]
fn curves_and_focus_have_a_contrast_of_at_least_3() {
    let curves =
        ["ideal", "actual", "step", "dir", "enable", "wire", "packet", "reply", "tick", "axis", "baseline"];
    at_least(3.0, &curves, &["pane"]);
    at_least(3.0, &["cursor-a", "cursor-b", "accent"], &["pane", "ground"]);
    at_least(3.0, &["focus"], &["pane", "ground", "raised"]);
    // The selected row has its own background.
    at_least(3.0, &["step", "dir", "enable", "wire"], &["chosen"]);
}
