//! What the program says of itself.

use crate::typed::{scenario, typed};

#[test]
fn help_reads_well() {
    insta::assert_snapshot!("help", typed(&scenario("shear"), &["--help"]).out);
    insta::assert_snapshot!("help_run", typed(&scenario("shear"), &["run", "-h"]).out);
    insta::assert_snapshot!("help_test", typed(&scenario("shear"), &["test", "-h"]).out);
    insta::assert_snapshot!("help_review", typed(&scenario("shear"), &["review", "-h"]).out);
}
