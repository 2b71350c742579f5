//! Which tests are meant, by name and by tag.

/// Words that choose tests; without any of a kind all pass.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Parts of names; a test has one of them.
    pub filters: Vec<String>,
    /// Tags; a test has one of them.
    pub tags: Vec<String>,
    /// Tags; a test has none of them.
    pub skipped_tags: Vec<String>,
}

impl Selection {
    /// True if nothing is left out.
    pub fn is_all(&self) -> bool {
        self.filters.is_empty() && self.tags.is_empty() && self.skipped_tags.is_empty()
    }

    /// True if a test of this name, as in `scenarios/shear/default`, passes.
    pub fn has_name(&self, suite: &str, name: &str) -> bool {
        let full = format!("{suite}/{name}");
        self.filters.is_empty() || self.filters.iter().any(|part| full.contains(part.as_str()))
    }

    /// True if a test with these tags passes.
    pub fn has_tags(&self, tags: &[String]) -> bool {
        let any = |wanted: &[String]| wanted.iter().any(|tag| tags.contains(tag));
        (self.tags.is_empty() || any(&self.tags)) && !any(&self.skipped_tags)
    }
}
