//! Three PLCs side by side: the original on its own clock, the instrumented one that is not simulated, and the
//! instrumented one under grants.

use onescan_iec::TaskPlan;
use onescan_iec_run::{Application, SoftPlc};

use super::corpus::input;
use super::driver::{Driver, scan, write};

pub(crate) struct Abreast {
    pub(crate) plain: SoftPlc,
    pub(crate) inert: SoftPlc,
    pub(crate) driver: Driver,
}

impl Abreast {
    /// `free` has the tasks as they were and the scheduler, `granted` those of a PLC under grants.
    pub(crate) fn new(plain: SoftPlc, shimmed: &Application, free: &TaskPlan, granted: &TaskPlan) -> Self {
        Self::new_in("", plain, shimmed, free, granted)
    }

    /// The same where the shim's variables are parts of another.
    pub(crate) fn new_in(
        prefix: &'static str,
        plain: SoftPlc,
        shimmed: &Application,
        free: &TaskPlan,
        granted: &TaskPlan,
    ) -> Self {
        let mut inert = SoftPlc::new(shimmed, free).expect("the plan suits");
        write(&mut inert, &format!("{prefix}SDSP_Simulated"), 0);
        Self { plain, inert, driver: Driver::joined_in(prefix, shimmed, granted) }
    }

    /// All go to `t_v` with the same inputs; the granted PLC idles behind it for a while, as its gateway is slow.
    pub(crate) fn step(&mut self, step: u64, t_v: u64, inputs: &[&str]) {
        self.step_where(step, t_v, inputs, &|path| path.to_owned());
    }

    /// The same where what is instrumented has inputs at paths of its own.
    pub(crate) fn step_where(&mut self, step: u64, t_v: u64, inputs: &[&str], moved: &dyn Fn(&str) -> String) {
        for (index, path) in inputs.iter().enumerate() {
            let value = input(index, step);
            write(&mut self.plain, path, value);
            write(&mut self.inert, &moved(path), value);
            self.driver.rig.set(&moved(path), value);
        }
        scan(&mut self.plain, t_v);
        scan(&mut self.inert, t_v);
        self.driver.step(t_v);
        self.driver.cycles((step % 4) as u32);
    }

    /// The one under grants.
    pub(crate) fn granted(&self) -> &SoftPlc {
        &self.driver.rig.plc
    }
}
