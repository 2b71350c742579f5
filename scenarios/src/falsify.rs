//! `[falsify]` bound to the signals and clients of its scenario.

use std::cmp::Ordering;
use std::ops::Range;

use onescan_server::signal::{ClientName, SignalName, SignalType, did_you_mean};
use onescan_server::time::{TimeSpan, VirtualTime};
use toml::Spanned;

use crate::error::Wrong;
use crate::falsify_file::{ShapeFile, VariedInputFile, VariedParameterFile};
use crate::file::ScenarioFile;

pub use crate::falsify_file::ShapeFile as Shape;

/// What may be varied.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Varied {
    /// Operator's inputs, in the order of the file.
    pub inputs: Vec<VariedInput>,
    /// Parameters, in the order of the file.
    pub parameters: Vec<VariedParameter>,
}

/// An input that is varied over time.
#[derive(Clone, Debug, PartialEq)]
pub struct VariedInput {
    pub signal: SignalName,
    /// Its type: a BOOL, an integer, REAL or LREAL.
    pub ty: SignalType,
    /// Least and greatest value; of a BOOL 0 and 1.
    pub range: [f64; 2],
    /// What it is between its control points.
    pub shape: Shape,
    /// How many control points it has.
    pub points: u32,
    /// Time of the first one.
    pub from: VirtualTime,
    /// Time of the last one, or end of the last piece; nothing if that is the end of the run.
    pub until: Option<VirtualTime>,
    /// How often it changes between them, if it is linear.
    pub every: TimeSpan,
}

/// A value that is varied from run to run.
#[derive(Clone, Debug, PartialEq)]
pub struct VariedParameter {
    /// Its path, the client first.
    pub path: String,
    /// Least and greatest value.
    pub range: [f64; 2],
    pub is_whole: bool,
    /// Where it stands in `scenario.toml`.
    pub place: Range<usize>,
}

impl Varied {
    /// True if nothing is varied.
    pub fn is_empty(&self) -> bool {
        self.inputs.is_empty() && self.parameters.is_empty()
    }
}

/// Most control points of an input.
const POINTS_MAX: u32 = 1_000;

/// What `[falsify]` says.
pub(crate) fn bind(file: &ScenarioFile) -> Result<Varied, Wrong> {
    let mut varied = Varied::default();
    for written in &file.falsify.input {
        let input = input(file, written)?;
        if varied.inputs.iter().any(|other| other.signal == input.signal) {
            let message = format!("`{}` is varied twice", input.signal);
            return Err(Wrong { message, place: written.signal.span(), help: Some("name it once".to_owned()) });
        }
        varied.inputs.push(input);
    }
    for written in &file.falsify.parameter {
        varied.parameters.push(parameter(file, written)?);
    }
    Ok(varied)
}

fn input(file: &ScenarioFile, written: &VariedInputFile) -> Result<VariedInput, Wrong> {
    let signal = written.signal.get_ref();
    let wrong = |message: String, help: Option<String>| Wrong { message, place: written.signal.span(), help };
    let Some(declared) = file.signals.get(signal) else {
        let help = did_you_mean(signal.as_str(), file.signals.keys().map(SignalName::as_str));
        return Err(wrong(format!("the scenario has no signal `{signal}`"), help));
    };
    let ty = declared.get_ref().ty;
    let range = match (ty, &written.range) {
        (SignalType::BOOL, None) => [0.0, 1.0],
        (SignalType::BOOL, Some(range)) => {
            let message = format!("`{signal}` is a BOOL, which has no range");
            return Err(Wrong { message, place: range.span(), help: Some("leave `range` out".to_owned()) });
        }
        (_, None) => return Err(wrong(format!("`{signal}` is {ty} and needs a `range`"), None)),
        (_, Some(range)) => {
            let Some(bounds) = bounds(ty) else {
                let help = Some("a BOOL, an integer, REAL or LREAL can".to_owned());
                return Err(wrong(format!("`{signal}` is {ty}, which cannot be varied"), help));
            };
            checked(range, bounds, &format!("{ty}"))?
        }
    };
    let points = *written.points.get_ref();
    let least = if written.shape == ShapeFile::Linear { 2 } else { 1 };
    if !(least..=POINTS_MAX).contains(&points) {
        let message = format!("`{signal}` has from {least} to {POINTS_MAX} control points, not {points}");
        return Err(Wrong { message, place: written.points.span(), help: None });
    }
    let (from, until) = (written.from.unwrap_or_default(), written.until);
    let end = until.unwrap_or(file.until);
    if from >= end {
        let message = format!("`{signal}` is varied from {from} on, and no longer than until {end}");
        return Err(wrong(message, Some("let it begin earlier".to_owned())));
    }
    let pieces = if written.shape == ShapeFile::Linear { points - 1 } else { points };
    let step = file.step;
    if (end.as_nanos() - from.as_nanos()) / u64::from(pieces) < step.as_nanos() {
        let message = format!("the control points of `{signal}` are nearer to each other than a step, {step}");
        return Err(Wrong { message, place: written.points.span(), help: Some("let it have fewer".to_owned()) });
    }
    let every = written.every.unwrap_or(step);
    if written.every.is_some() && (written.shape != ShapeFile::Linear || !every.is_multiple_of(step)) {
        let message = format!("`every` of `{signal}` is for a linear input, and a multiple of the step {step}");
        return Err(wrong(message, None));
    }
    Ok(VariedInput { signal: signal.clone(), ty, range, shape: written.shape, points, from, until, every })
}

fn parameter(file: &ScenarioFile, written: &VariedParameterFile) -> Result<VariedParameter, Wrong> {
    let path = written.path.get_ref();
    let client = path.split('.').next().unwrap_or_default();
    if file.clients.keys().all(|known| known.as_str() != client) {
        let help = did_you_mean(client, file.clients.keys().map(ClientName::as_str));
        let message = format!("the scenario has no client `{client}`");
        return Err(Wrong { message, place: written.path.span(), help });
    }
    let range = checked(&written.range, [f64::MIN, f64::MAX], "a parameter")?;
    Ok(VariedParameter { path: path.clone(), range, is_whole: written.whole, place: written.path.span() })
}

/// A range that has a least and a greatest value, both within `bounds`.
fn checked(range: &Spanned<[f64; 2]>, bounds: [f64; 2], of: &str) -> Result<[f64; 2], Wrong> {
    let [least, greatest] = *range.get_ref();
    let wrong = |message: String| Err(Wrong { message, place: range.span(), help: None });
    // Nothing is less than NaN.
    if least.partial_cmp(&greatest) != Some(Ordering::Less) {
        return wrong(format!("a range goes from its least value to its greatest, not from {least} to {greatest}"));
    }
    if !(bounds[0]..=bounds[1]).contains(&least) || !(bounds[0]..=bounds[1]).contains(&greatest) {
        return wrong(format!("{of} has values from {} to {}", bounds[0], bounds[1]));
    }
    Ok([least, greatest])
}

/// The least and the greatest value of a type of numbers.
fn bounds(ty: SignalType) -> Option<[f64; 2]> {
    use SignalType as T;
    let integer = |bits: u32, is_signed: bool| {
        let all = (1_u64 << bits) as f64;
        if is_signed { [-all / 2.0, all / 2.0 - 1.0] } else { [0.0, all - 1.0] }
    };
    Some(match ty {
        T::SINT => integer(8, true),
        T::INT => integer(16, true),
        T::DINT => integer(32, true),
        T::USINT => integer(8, false),
        T::UINT => integer(16, false),
        T::UDINT => integer(32, false),
        // Beyond 53 bits not every whole number is one of 64 bits of a mantissa.
        T::LINT => [-9_007_199_254_740_992.0, 9_007_199_254_740_992.0],
        T::ULINT => [0.0, 9_007_199_254_740_992.0],
        T::REAL => [f64::from(f32::MIN), f64::from(f32::MAX)],
        T::LREAL => [f64::MIN, f64::MAX],
        _ => return None,
    })
}
