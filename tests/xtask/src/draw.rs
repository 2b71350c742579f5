//! Functions drawn by a seed: a sample of the sources that anybody can draw again.

use std::path::Path;

use crate::error::TaskError;
use crate::rust::function::functions;
use crate::rust::package::package;
use crate::workspace::{members, sources};

/// `count` functions of the sources without tests as `path:line name`, each with the same chance.
///
/// # Errors
/// A source or a manifest cannot be read.
pub(crate) fn drawn(root: &Path, seed: u64, count: usize) -> Result<Vec<String>, TaskError> {
    let mut all = Vec::new();
    for (member, files) in sources(root, &members(root)?)? {
        for file in package(root, &member, &files)?.iter().filter(|file| !file.is_test) {
            let place = file.path.to_string_lossy().replace('\\', "/");
            let found = functions(&file.source.tokens).into_iter();
            all.extend(found.map(|each| format!("{place}:{} {}", each.line, each.name)));
        }
    }
    Ok(sample(all, seed, count))
}

/// The first places of a shuffle by Fisher and Yates.
fn sample<T>(mut all: Vec<T>, seed: u64, count: usize) -> Vec<T> {
    let count = count.min(all.len());
    let mut state = seed;
    for at in 0..count {
        let left = (all.len() - at) as u64;
        // The bias of a remainder is below 2⁻⁴⁰ for fewer than 2²⁴ functions.
        let offset = (next(&mut state) % left) as usize;
        all.swap(at, at + offset);
    }
    all.truncate(count);
    all
}

/// `SplitMix64`, whose numbers are the same on every system.
fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut mixed = *state;
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ (mixed >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_draws_the_same_again_and_nothing_twice() {
        let all: Vec<u32> = (0..1000).collect();
        let drawn = sample(all.clone(), 7, 100);
        assert_eq!(drawn, sample(all.clone(), 7, 100));
        assert_ne!(drawn, sample(all.clone(), 8, 100));
        let mut once = drawn.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), 100);
        assert_eq!(sample(all, 7, 5000).len(), 1000);
    }

    #[test]
    fn the_generator_is_the_published_one() {
        let mut state = 1_234_567;
        assert_eq!([next(&mut state), next(&mut state)], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }
}
