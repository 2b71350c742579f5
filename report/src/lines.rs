//! Text in lines that a terminal shows.

/// Columns of a terminal.
pub const WIDTH: usize = 80;

/// Broken at blanks into lines of so many letters; a longer word has a line of its own. One line at least.
pub fn broken(text: &str, room: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    if lines.is_empty() {
        lines.push(String::new());
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_never_broken() {
        assert_eq!(broken("while it melts, slow-sampling", 14), ["while it", "melts,", "slow-sampling"]);
        assert_eq!(broken("uneven,speed_m_s=0.15", 4), ["uneven,speed_m_s=0.15"]);
        assert_eq!(broken(" ", 4), [""]);
    }
}
