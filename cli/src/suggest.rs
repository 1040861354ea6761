//! Suggests the known name that is most similar to an unknown one.

/// Below this similarity a name is not a misspelling.
const MIN_LIKENESS: f64 = 0.85;

pub(crate) fn nearest<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let likeness = |name: &'a str| (strsim::jaro_winkler(given, name), name);
    let likely = known.into_iter().map(likeness).filter(|(likeness, _)| *likeness > MIN_LIKENESS);
    likely.max_by(|(one, _), (other, _)| one.total_cmp(other)).map(|(_, name)| name)
}

/// `; a similar name is NAME`, or nothing.
pub(crate) fn hint<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(given, known).map_or_else(String::new, |name| format!("; a similar name is {name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_suggested_if_it_is_nearly_the_given_one() {
        let known = ["slots", "channels", "step_period_cycles", "settle_cycles"];
        for (given, expected) in [
            ("slot", Some("slots")),
            ("chanels", Some("channels")),
            ("step_period", Some("step_period_cycles")),
            ("voltage", None),
            ("", None),
        ] {
            assert_eq!(nearest(given, known), expected, "{given}");
        }
        assert_eq!(hint("slot", known), "; a similar name is slots");
    }
}
