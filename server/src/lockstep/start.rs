//! The start logic of `[SDSP]` sec. IV. A session whose clients are all there takes their initial values; virtual time stands
//! until these, with what operators have written over them, are as they must be. It changes no step: only when the first comes.

use onescan_base::notice::NOTICE;

use super::Lockstep;
use crate::layout::ImageLayout;
use crate::operation::Control;
use crate::time::StepCount;

/// Whether something holds on an image with this layout.
pub type Holds = Box<dyn Fn(&ImageLayout, &[u8]) -> bool>;

/// What must hold before the first step.
pub struct StartLogic {
    /// The formula as it is written, for messages.
    pub what: String,
    pub holds: Holds,
    /// Whether anybody may come and make it hold.
    pub attendance: Attendance,
}

/// Whether somebody can operate a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attendance {
    /// It waits for them.
    Attended,
    /// It is stopped instead: it would wait for ever.
    Unattended,
}

impl Lockstep {
    /// Lets virtual time stand at its start until this holds on the values that the first step would commit if all clients
    /// slept. A session that goes on from a checkpoint has started.
    pub fn set_start_logic(&mut self, logic: StartLogic) {
        self.start_logic = Some(logic);
    }

    /// False for a session that was stopped because its start logic did not hold, and nobody could change that.
    pub fn could_start(&self) -> bool {
        self.could_start
    }

    /// At a boundary, behind what operators wish: looks whether the first step may come.
    pub(super) fn look_for_start(&mut self) {
        let Some(logic) = &self.start_logic else { return };
        if self.digest.is_none() || self.session.cycle().steps() != StepCount(0) {
            return;
        }
        let holds = (logic.holds)(self.session.layout(), &self.session.coming());
        if !holds && !self.session.waits_to_start() {
            match logic.attendance {
                Attendance::Attended => {
                    tracing::info!(target: NOTICE, "the session starts when this holds: {}", logic.what);
                }
                Attendance::Unattended => {
                    self.could_start = false;
                    self.session.control(Control::Stop);
                }
            }
        }
        self.session.set_start_logic(holds);
    }
}
