//! What of a Markdown file matters here: its links and the anchors of its headings.

use std::collections::{BTreeMap, BTreeSet};

/// A link and the line that it is on, counted from 1.
#[derive(Debug, PartialEq, Eq)]
pub struct Link {
    pub line: usize,
    pub target: String,
}

/// How many of the same mark begin a fence, and which; nothing for a line that is none.
fn fence(line: &str) -> Option<(char, usize)> {
    let line = line.trim_start();
    let mark = line.chars().next().filter(|mark| ['`', '~'].contains(mark))?;
    let count = line.chars().take_while(|each| *each == mark).count();
    (count >= 3).then_some((mark, count))
}

/// The lines outside of fenced code blocks, with their numbers. A block ends with a fence of the same mark that is at
/// least as long as the one that began it, so that blocks may show blocks.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut open: Option<(char, usize)> = None;
    text.lines().enumerate().filter_map(move |(index, line)| {
        match (open, fence(line)) {
            (None, None) => return Some((index + 1, line)),
            (None, begun) => open = begun,
            (Some((mark, count)), Some((other, long))) if mark == other && long >= count => open = None,
            (Some(_), _) => {}
        }
        None
    })
}

/// The line with every code span blanked out: links in it are not links.
fn without_code(line: &str) -> String {
    line.split('`').enumerate().map(|(piece, text)| if piece % 2 == 0 { text } else { "_" }).collect()
}

/// What of a file is code: its code spans and its fenced blocks.
pub fn code(text: &str) -> String {
    let outside: BTreeMap<usize, &str> = prose(text).collect();
    let mut found = String::new();
    for (index, line) in text.lines().enumerate() {
        match outside.get(&(index + 1)) {
            Some(prose) => prose.split('`').skip(1).step_by(2).for_each(|span| {
                found.push_str(span);
                found.push(' ');
            }),
            None => found.push_str(line),
        }
        found.push('\n');
    }
    found
}

/// All links and pictures of a file, written as `[text](target)` or as `[key]: target`.
pub fn links(text: &str) -> Vec<Link> {
    let mut found = Vec::new();
    for (line, content) in prose(text) {
        let content = without_code(content);
        for (at, _) in content.match_indices("](") {
            let rest = &content[at + 2..];
            // A title may follow the target: `(target "title")`.
            let end = rest.find([')', ' ']).unwrap_or(rest.len());
            found.push(Link { line, target: rest[..end].to_owned() });
        }
        if let Some((_, target)) = content.strip_prefix('[').and_then(|rest| rest.split_once("]: ")) {
            found.push(Link { line, target: target.trim().to_owned() });
        }
    }
    found
}

/// The anchors that a reader's browser finds in a file, made of its headings as GitHub makes them.
pub fn anchors(text: &str) -> BTreeSet<String> {
    let mut times: BTreeMap<String, usize> = BTreeMap::new();
    let mut found = BTreeSet::new();
    for (_, line) in prose(text) {
        let title = line.trim_start_matches('#');
        let level = line.len() - title.len();
        if !(1..=6).contains(&level) || !title.starts_with(' ') {
            continue;
        }
        let slug = slug(title.trim());
        let count = times.entry(slug.clone()).or_default();
        found.insert(if *count == 0 { slug } else { format!("{slug}-{count}") });
        *count += 1;
    }
    found
}

/// Small letters; spaces become hyphens; other marks go, as does the target of a link.
fn slug(title: &str) -> String {
    let mut shown = String::new();
    let mut rest = title;
    while let Some((before, after)) = rest.split_once("](") {
        shown.push_str(before);
        rest = after.split_once(')').map_or("", |(_, after)| after);
    }
    shown.push_str(rest);
    let kept = shown.chars().filter(|letter| letter.is_alphanumeric() || " -_".contains(*letter));
    kept.map(|letter| if letter == ' ' { '-' } else { letter }).collect::<String>().to_lowercase()
}

#[test]
fn headings_become_anchors() {
    let text = "# A `run`, in CI\n```sh\n# no heading\n```\n## See [this](x.md)\n## Again\n## Again\n#hashtag\n";
    let wanted = ["a-run-in-ci", "again", "again-1", "see-this"];
    assert_eq!(anchors(text), wanted.into_iter().map(str::to_owned).collect());
}

#[test]
fn links_outside_of_code_are_found() {
    let block = "````\n```\n[no](no.md)\n```\n[no](no.md)\n````\n";
    let text = format!("[a](b.md#c) and ![d](e.svg \"title\"), `[x](y)`\n{block}[key]: https://example.org\n");
    let targets: Vec<_> = links(&text).into_iter().map(|link| (link.line, link.target)).collect();
    let wanted = [(1, "b.md#c"), (1, "e.svg"), (8, "https://example.org")];
    assert_eq!(targets, wanted.map(|(line, target)| (line, target.to_owned())));
}

#[test]
fn code_is_what_is_marked_as_such() {
    assert_eq!(
        code("a `b` c `d`\n```toml\ne = 1\n```\nf\n").split_whitespace().collect::<Vec<_>>().join(" "),
        "b d ```toml e = 1 ```"
    );
}
