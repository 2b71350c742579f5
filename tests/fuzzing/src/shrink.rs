//! A finding, made as short as it can be and still be found.

/// The shortest input found in `tries` of which `still` is true, as it is of `input`.
pub fn shrink(mut input: Vec<u8>, mut tries: usize, mut still: impl FnMut(&[u8]) -> bool) -> Vec<u8> {
    let mut piece = input.len().div_ceil(2);
    while piece > 0 && tries > 0 {
        let mut at = 0;
        let mut is_shorter = false;
        while at < input.len() && tries > 0 {
            let end = (at + piece).min(input.len());
            let without = [&input[..at], &input[end..]].concat();
            tries -= 1;
            if still(&without) {
                input = without;
                is_shorter = true;
            } else {
                at = end;
            }
        }
        if !is_shorter || piece > input.len() {
            piece /= 2;
        }
    }
    input
}
