//! What elements need, in front of them.

/// `starts` and all that they need, each behind what it needs itself.
pub(in crate::input::plcopen_network) fn finished(starts: Vec<usize>, sources: &[Vec<usize>]) -> Vec<usize> {
    let mut order = Vec::new();
    let mut seen = vec![false; sources.len()];
    for start in starts {
        let mut open = vec![(start, 0)];
        if std::mem::replace(seen.get_mut(start).unwrap_or(&mut false), true) {
            continue;
        }
        while let Some((index, next)) = open.last_mut() {
            let source = sources.get(*index).and_then(|list| list.get(*next)).copied();
            *next += 1;
            if let Some(source) = source {
                if seen.get_mut(source).is_some_and(|seen| !std::mem::replace(seen, true)) {
                    open.push((source, 0));
                }
            } else {
                order.push(*index);
                open.pop();
            }
        }
    }
    order
}
