//! The name that was probably meant.

/// The candidate nearest to `wanted`, if any is near enough to have been meant: at most a third of the longer name's
/// characters is wrong, swapped, missing or too many, so that nothing is guessed among names of one or two. Case does
/// not count. Of equally near candidates the first by the alphabet.
///
/// ```
/// use onescan_base::nearest;
///
/// let names = ["Sensor_1", "Sensor_2", "Position_1"];
/// assert_eq!(nearest("Senosr_1", names), Some("Sensor_1"));
/// assert_eq!(nearest("Pump", names), None);
/// ```
pub fn nearest<'a>(wanted: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = wanted.to_lowercase();
    let length = wanted.chars().count();
    candidates
        .into_iter()
        .filter_map(|candidate| Some((rank(&wanted, length, &candidate.to_lowercase())?, candidate)))
        .min()
        .map(|(_, candidate)| candidate)
}

/// How far the two are apart, as a rank: wrong characters in a million of the longer name. Nothing if that is too far.
fn rank(wanted: &str, length: usize, candidate: &str) -> Option<usize> {
    let other = candidate.chars().count();
    let (longer, shorter) = (length.max(other), length.min(other));
    let wrong_max = longer / 3;
    // Distances are quadratic in the lengths; most candidates of a large program are excluded by theirs.
    if longer - shorter > wrong_max {
        return None;
    }
    let wrong = strsim::damerau_levenshtein(wanted, candidate);
    (wrong <= wrong_max).then(|| wrong * 1_000_000 / longer.max(1))
}

/// The nearest of `candidates` as a hint, if any is near enough to have been meant; see [`nearest`].
///
/// ```
/// use onescan_base::did_you_mean;
///
/// assert_eq!(did_you_mean("sensr_1", ["Sensor_1"]).as_deref(), Some("did you mean `Sensor_1`?"));
/// assert_eq!(did_you_mean("Pump", ["Sensor_1"]), None);
/// ```
#[must_use]
pub fn did_you_mean<'a>(wanted: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(wanted, candidates).map(|name| format!("did you mean `{name}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_found() {
        let names = ["Sensor_1", "Sensor_2", "Position_1"];
        assert_eq!(nearest("Senosr_1", names), Some("Sensor_1"));
        assert_eq!(nearest("sensor_2", names), Some("Sensor_2"));
        assert_eq!(nearest("Sensor", names), Some("Sensor_1"), "equally near");
        assert_eq!(nearest("conveyor", names), None);
        assert_eq!(nearest("", names), None);
    }

    #[test]
    fn short_names_are_not_guessed() {
        assert_eq!(nearest("x", ["y", "xy"]), None);
        assert_eq!(nearest("ab", ["ac", "cb"]), None);
        assert_eq!(nearest("t11", ["T1", "Tx"]), Some("T1"));
        assert_eq!(nearest("x", ["X"]), Some("X"));
        assert_eq!(nearest("Rum", ["Run"]), Some("Run"));
    }

    #[test]
    fn two_thirds_of_a_name_must_be_right() {
        assert_eq!(nearest("Motro", ["Motor"]), Some("Motor"));
        assert_eq!(nearest("Valve", ["Value"]), Some("Value"));
        assert_eq!(nearest("Drive", ["Dodge"]), None);
        assert_eq!(nearest("Position", ["Position_10"]), Some("Position_10"));
    }
}
