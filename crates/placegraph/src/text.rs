//! What of a text can be shown.

/// Whether `text` has 1 to `max` characters that all can be shown, in one line and one direction.
pub fn is_printable(text: &str, max: usize) -> bool {
    !text.is_empty() && text.chars().take(max + 1).count() <= max && text.chars().all(is_shown)
}

/// `text` with a low line for every character that cannot be shown.
pub fn printable(text: &str) -> String {
    text.chars().map(|c| if is_shown(c) { c } else { '_' }).collect()
}

/// Whether a character can be printed: it is not a control character, does not change the line or the direction of
/// the text around it, and is a character that XML allows.
pub fn is_shown(c: char) -> bool {
    let is_layout =
        matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}');
    let is_none = u32::from(c) & 0xfffe == 0xfffe || ('\u{fdd0}'..='\u{fdef}').contains(&c);
    !c.is_control() && !is_layout && !is_none
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_terminals_and_xml_cannot_show_is_not_printable() {
        for good in ["kitchen", "Büro 3b", "会议室", "a", "Dr. O'Neill & co <lab>"] {
            assert!(is_printable(good, 30), "{good}");
        }
        for bad in
            ["", "a\nb", "\u{7}bell", "\0", "\u{1b}[2J", "\u{fffe}", "\u{ffff}", "a\u{2028}b", "\u{202e}abc"]
        {
            assert!(!is_printable(bad, 30), "{bad:?}");
        }
        assert!(is_printable(&"ä".repeat(30), 30) && !is_printable(&"ä".repeat(31), 30));
        assert_eq!(printable("a\u{1b}]0;b\nc"), "a_]0;b_c");
    }
}
