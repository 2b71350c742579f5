//! What comes from any state when nobody starts the PLC or leaves the session: that something good still can
//! come is the half of "not at all" that no single state shows.

use stateright::{Model, Property};

use super::gateway::{Gateway, Verdict};
use super::{SESSIONS, Shim, ShimAct, ShimState, project, project_interrupted, project_with_single};
use crate::graph::explore;
use crate::stamped::report;

/// The same model from all states that it can reach, without disturbance.
struct Undisturbed<'a> {
    model: &'a Shim,
    from: Vec<ShimState>,
}

impl Model for Undisturbed<'_> {
    type State = ShimState;
    type Action = ShimAct;

    fn init_states(&self) -> Vec<ShimState> {
        self.from.clone()
    }

    fn actions(&self, state: &ShimState, actions: &mut Vec<ShimAct>) {
        self.model.actions(state, actions);
        let disturbs = |act: &ShimAct| match act {
            ShimAct::Leave | ShimAct::Start => true,
            ShimAct::Deliver(message) => message.session == 0,
            ShimAct::Read(_, verdict) => *verdict == Verdict::Over,
            ShimAct::Cycle(_) => false,
        };
        actions.retain(|act| !disturbs(act));
    }

    fn next_state(&self, last: &ShimState, action: ShimAct) -> Option<ShimState> {
        self.model.next_state(last, action)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        Vec::new()
    }
}

/// States in which the PLC takes part in the gateway's session, or may still, but some grant is never done and
/// the gateway is not notified that it is over.
pub(super) fn stuck(model: &Shim) -> usize {
    let from = explore(model).states;
    let graph = explore(&Undisturbed { model, from });
    let is_out = |state: &ShimState| {
        let (view, session) = (model.view(state), model.session(state));
        view.joined != session && !view.is_fresh
    };
    graph.cannot_reach(|state| {
        let is_silent = state.gateway.session == model.gateway.sessions.len();
        let is_done = state.gateway.waiting > model.gateway.grants;
        let is_over = || model.gateway.judge(state.gateway, model.view(state)) == Some(Verdict::Over);
        is_silent || is_done || state.broken.is_some() || is_out(state) || is_over()
    })
}

#[test]
fn every_grant_is_run_or_the_session_seen_to_be_over() {
    for project in [project(), project_with_single(), project_interrupted()] {
        let model = Shim::of(&project, Gateway::new(&SESSIONS[..3], 3), &[]);
        assert_eq!(stuck(&model), 0);
    }
    report(format_args!("shim: from every state of a session, every grant is done or it is seen to be over"));
}
