//! The same networks drawn in other ways have the same values: moved by some pixels, stretched, with other ids and,
//! where the drawing has the order, with their elements elsewhere in the file. `ONESCAN_DRAWINGS=20000` tries more.

use super::sketch::{Drawing, Sketch};
use super::{BEREMIZ, CODESYS, OPENPLC_4, OTHER, values};
use crate::matiec::dice::Dice;
use crate::plcopen::{of_tool, rig};

const SCANS: usize = 20;
/// Drawings of each network, the first one included.
const DRAWINGS: usize = 5;

fn drawn(sketch: &Sketch, tool: &str, drawing: &Drawing, seed: u64) -> Vec<i64> {
    values(rig(&of_tool(tool, &sketch.project(drawing))), SCANS, seed)
}

#[test]
fn other_drawings_of_a_network_have_its_values() {
    let count = std::env::var("ONESCAN_DRAWINGS").ok().and_then(|text| text.parse().ok()).unwrap_or(500);
    let (mut differ, mut alive) = (0, 0);
    for seed in 0..(count / DRAWINGS) as u64 {
        let mut dice = Dice::new(seed);
        let sketch = Sketch::random(&mut dice, false);
        let tool = [OTHER, OPENPLC_4, CODESYS, BEREMIZ][seed as usize / 2 % 4];
        let in_file = tool == CODESYS || tool == BEREMIZ;
        let first = drawn(&sketch, tool, &Drawing::plain(&sketch), seed);
        alive += usize::from(first.windows(2).any(|pair| pair[0] != pair[1]));
        for number in 1..DRAWINGS {
            let drawing = Drawing::other(&sketch, in_file, &mut dice);
            let other = drawn(&sketch, tool, &drawing, seed);
            assert_eq!(other, first, "seed {seed}, drawing {number}, `{tool}`:\n{}", sketch.project(&drawing));
        }
        // The law says something: a drawing with the order of its elements turned round is another program.
        let turned = drawn(&sketch, tool, &Drawing::turned(&sketch), seed);
        differ += usize::from(turned != first);
    }
    let networks = count / DRAWINGS;
    assert!(alive * 10 > networks * 9 && differ * 4 > networks, "{alive} live and {differ} depend on the order");
}
