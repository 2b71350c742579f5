//! Charts by the words of the standard, without any of the compiler: a second opinion.

use super::chart::{ACTIONS, BOOLEAN, Chart, Condition, INPUTS, Use};

/// What is known of an action.
#[derive(Debug, Clone, Copy, Default)]
#[expect(clippy::struct_excessive_bools, reason = "the action control's figure is made of flags")]
struct Control {
    /// Set by S and not reset since.
    stored: bool,
    /// When the input of a qualifier with a time became TRUE, or when it was stored.
    limited: Option<u64>,
    delayed: Option<u64>,
    stored_delayed: Option<u64>,
    delayed_stored: Option<u64>,
    is_delayed_stored: bool,
    stored_limited: Option<u64>,
    pulse: bool,
    rising: bool,
    falling: bool,
    flag: bool,
}

pub(crate) struct Interpreter<'c> {
    chart: &'c Chart,
    pub(crate) active: Vec<bool>,
    pub(crate) elapsed_ms: Vec<u64>,
    since_ms: Vec<u64>,
    begun: bool,
    controls: [Control; ACTIONS],
    pub(crate) log: u32,
}

impl<'c> Interpreter<'c> {
    pub(crate) fn new(chart: &'c Chart) -> Self {
        let mut active = vec![false; chart.steps];
        active[0] = true;
        let zeros = || vec![0; chart.steps];
        let controls = [Control::default(); ACTIONS];
        Self { chart, active, elapsed_ms: zeros(), since_ms: zeros(), begun: false, controls, log: 0 }
    }

    pub(crate) fn flag(&self, action: usize) -> bool {
        self.controls[action].flag
    }

    pub(crate) fn scan(&mut self, now_ms: u64, inputs: [bool; INPUTS]) {
        if self.begun {
            self.evolve(now_ms, inputs);
        } else {
            self.begun = true;
            self.since_ms[0] = now_ms;
        }
        self.act(now_ms);
    }

    fn evolve(&mut self, now_ms: u64, inputs: [bool; INPUTS]) {
        for step in 0..self.chart.steps {
            if self.active[step] {
                self.elapsed_ms[step] = now_ms - self.since_ms[step];
            }
        }
        let mut order: Vec<_> = self.chart.links.iter().collect();
        order.sort_by_key(|link| link.priority.unwrap_or(u32::MAX));
        let mut left = self.active.clone();
        let mut entered: Vec<usize> = Vec::new();
        for link in order {
            let holds = match link.condition {
                Condition::Input(number) => inputs[number],
                Condition::Elapsed(step, ms) => self.elapsed_ms[step] >= ms,
                Condition::Active(step) => self.active[step],
                Condition::Always => true,
            };
            if holds && link.from.iter().all(|step| left[*step]) {
                link.from.iter().for_each(|step| left[*step] = false);
                entered.extend(link.to.iter().copied());
            }
        }
        self.active = left;
        for step in entered {
            assert!(!self.active[step], "the chart is safe");
            self.active[step] = true;
            (self.elapsed_ms[step], self.since_ms[step]) = (0, now_ms);
        }
    }

    fn act(&mut self, now_ms: u64) {
        let mut order: Vec<usize> = Vec::new();
        for used in &self.chart.uses {
            if !order.contains(&used.action) {
                order.push(used.action);
            }
        }
        let mut running: Vec<(bool, usize)> = Vec::new();
        for action in order {
            let runs = self.control(action, now_ms);
            if runs && action >= BOOLEAN {
                running.push((self.controls[action].flag, action));
            }
        }
        running.sort_by_key(|(flag, _)| *flag);
        for (flag, action) in running {
            let value = action as u32 * 2 + u32::from(flag);
            self.log = self.log.wrapping_mul(31).wrapping_add(value);
        }
    }

    /// True if the action runs in this scan.
    fn control(&mut self, action: usize, now_ms: u64) -> bool {
        let uses: Vec<&Use> = self.chart.uses.iter().filter(|used| used.action == action).collect();
        let wants = |qualifier: &str| uses.iter().any(|used| used.qualifier == qualifier && self.active[used.step]);
        let time_ms = uses.iter().map(|used| used.time_ms * u64::from(is_timed(used.qualifier))).max().unwrap_or(0);
        let (reset, state) = (wants("R"), &mut self.controls[action].clone());
        let over = |since: Option<u64>| since.is_some_and(|since| now_ms - since >= time_ms);
        let held = |since: Option<u64>, wanted: bool| if wanted { since.or(Some(now_ms)) } else { None };
        state.stored = !reset && (state.stored || wants("S"));
        state.limited = held(state.limited, wants("L"));
        state.delayed = held(state.delayed, wants("D"));
        state.stored_delayed = held(state.stored_delayed, !reset && (wants("SD") || state.stored_delayed.is_some()));
        state.delayed_stored = held(state.delayed_stored, wants("DS"));
        state.is_delayed_stored = !reset && (state.is_delayed_stored || over(state.delayed_stored));
        state.stored_limited = held(state.stored_limited, !reset && (wants("SL") || state.stored_limited.is_some()));
        let pulse = wants("P") && !state.pulse;
        let edges = wants("P1") && !state.rising || !wants("P0") && state.falling;
        let before = state.flag;
        state.flag = !reset
            && (wants("N")
                || state.stored
                || state.limited.is_some() && !over(state.limited)
                || over(state.delayed)
                || pulse
                || over(state.stored_delayed)
                || state.is_delayed_stored
                || state.stored_limited.is_some() && !over(state.stored_limited));
        (state.pulse, state.rising, state.falling) = (wants("P"), wants("P1"), wants("P0"));
        let runs = state.flag || before || edges;
        self.controls[action] = *state;
        runs
    }
}

pub(crate) fn is_timed(qualifier: &str) -> bool {
    matches!(qualifier, "L" | "D" | "SD" | "DS" | "SL")
}
