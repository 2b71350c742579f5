//! The order of evaluation (2nd ed. 4.1.3, 4.3.3; 3rd ed. 8.1.4), which each tool decides in its own way.
//!
//! | module | subject |
//! |---|---|
//! | `flow` | by the flow of data: the standard's order, and that of CODESYS, TwinCAT and `OpenPLC` 4 |
//! | `rank` | what comes first where the flow of data leaves it open |
//! | `beremiz` | as the generator of Beremiz and `OpenPLC` 1 has it |
//! | `finished` | what elements need, in front of them |
//! | `step` | what is done with one element after the other |

mod beremiz;
mod finished;
mod flow;
mod rank;
mod step;

pub(super) use self::beremiz::Problem;
pub(super) use self::finished::finished;
pub(super) use self::rank::Rank;
pub(super) use self::step::Step;
use super::element::Node;
use crate::input::plcopen_tool::Tool;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rule {
    /// By the flow of data; `true` if what the flow leaves open is in the order of the file.
    Flow(bool),
    Beremiz,
}

impl Rule {
    /// The rule of the tool. Beremiz has no jumps in its networks, so nobody knows its order of them.
    pub(super) fn of(tool: Tool, nodes: &[Node<'_>]) -> Self {
        let divided = nodes.iter().any(|node| node.kind.is_control() || node.kind == super::element::Kind::Label);
        match tool {
            Tool::Codesys | Tool::TwinCat => Self::Flow(true),
            Tool::Beremiz if !divided => Self::Beremiz,
            Tool::Beremiz | Tool::OpenPlc4 | Tool::Other => Self::Flow(false),
        }
    }
}

/// Where elements come if the flow of data leaves it open.
pub(super) fn ranks(nodes: &[Node<'_>], networks: &[usize], as_in_file: bool) -> Vec<Rank> {
    if as_in_file { rank::by_file(nodes) } else { rank::by_drawing(nodes, networks) }
}

/// All elements by the flow of data; `sources` have no loops.
pub(super) fn by_flow(
    nodes: &[Node<'_>],
    networks: &[usize],
    sources: &[Vec<usize>],
    ranks: &[Rank],
    as_in_file: bool,
) -> Vec<Step> {
    let places = rank::places(nodes, networks, as_in_file);
    flow::order(nodes, sources, ranks, places, as_in_file).into_iter().map(Step::Evaluate).collect()
}

/// All elements, or what `end` needs, as the generator of Beremiz has them; and what is wrong with that.
pub(super) fn by_beremiz(nodes: &[Node<'_>], sources: &[Vec<usize>], end: Option<usize>) -> (Vec<Step>, Vec<Problem>) {
    beremiz::order(nodes, sources, end)
}
