//! Suggests the known name that is most similar to an unknown one.

/// Below this similarity a name is not a misspelling.
const MIN_SIMILARITY: f64 = 0.85;

pub(crate) fn nearest<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let similarity = |name: &'a str| (strsim::jaro_winkler(given, name), name);
    let similar = known.into_iter().map(similarity).filter(|(similarity, _)| *similarity > MIN_SIMILARITY);
    similar.max_by(|(one, _), (other, _)| one.total_cmp(other)).map(|(_, name)| name)
}

/// `; a similar name is NAME`, or nothing.
pub(crate) fn hint<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(given, known).map_or_else(String::new, |name| format!("; a similar name is {name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggests_only_similar_names() {
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
