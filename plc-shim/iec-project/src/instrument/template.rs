//! The shim's sources, and what becomes of them: names in them stand for a project's data.
//!
//! Each is program text that can be read and parsed as it is. A line with `(*$ltime` in it is for
//! projects that use LTIME only, since older systems do not know that type; one with `(*$exchange` for those whose signals go in data blocks, one with `(*$instances`
//! for programs of which a configuration has several. A line with `(*$each` is repeated for each task with
//! SINGLE; one with `(*$input`, `(*$external` or `(*$event` for those that are read or started in that way.

use onescan_iec::dialect::Dialect;
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::Token;
use onescan_iec::syntax::tokenize;

pub(super) const LINE: &str = include_str!("../../shim/line.st");
pub(super) const GLOBALS: &str = include_str!("../../shim/globals.st");
pub(super) const SCHEDULER: &str = include_str!("../../shim/scheduler.st");
pub(super) const EVENT_SCHEDULER: &str = include_str!("../../shim/event_scheduler.st");
pub(super) const FOLLOW: &str = include_str!("../../shim/follow.st");
pub(super) const EXECUTION_CONTROLLER: &str = include_str!("../../shim/execution_controller.st");
pub(super) const CHART_CONTROLLER: &str = include_str!("../../shim/chart_controller.st");
pub(super) const ACTION_CONTROL: &str = include_str!("../../shim/action_control.st");
pub(super) const STEP: &str = include_str!("../../shim/step.st");
pub(super) const ELAPSED: &str = include_str!("../../shim/elapsed.st");
pub(super) const ON_DELAY: &str = include_str!("../../shim/on_delay.st");
pub(super) const OFF_DELAY: &str = include_str!("../../shim/off_delay.st");
pub(super) const PULSE: &str = include_str!("../../shim/pulse.st");
pub(super) const REAL_TIME_CLOCK: &str = include_str!("../../shim/real_time_clock.st");
pub(super) const DURATION: &str = include_str!("../../shim/duration.st");
pub(super) const TIME_FUNCTION: &str = include_str!("../../shim/time_function.st");

pub(super) const SCL_GLOBALS: &str = include_str!("../../shim/scl/globals.scl");
pub(super) const SCL_SCHEDULER: &str = include_str!("../../shim/scl/scheduler.scl");
pub(super) const SCL_EXCHANGE: &str = include_str!("../../shim/scl/exchange.scl");
pub(super) const SCL_EXECUTION_CONTROLLER: &str = include_str!("../../shim/scl/execution_controller.scl");
pub(super) const SCL_ON_DELAY: &str = include_str!("../../shim/scl/on_delay.scl");
pub(super) const SCL_OFF_DELAY: &str = include_str!("../../shim/scl/off_delay.scl");
pub(super) const SCL_PULSE: &str = include_str!("../../shim/scl/pulse.scl");

/// Whom a line marked `(*$..` is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Only {
    /// Projects that use LTIME.
    LongTime,
    /// Programs of which there are several instances.
    Instances,
    /// Projects whose signals go in data blocks.
    Exchange,
}

impl Only {
    fn named(text: &str) -> Option<Self> {
        match text.split(|one: char| !one.is_ascii_alphabetic()).next() {
            Some("ltime") => Some(Self::LongTime),
            Some("instances") => Some(Self::Instances),
            Some("exchange") => Some(Self::Exchange),
            _ => None,
        }
    }
}

/// The template without the lines that are for others than `wanted`.
pub(super) fn lines_for(template: &str, wanted: &[Only]) -> String {
    let mut text = String::with_capacity(template.len());
    for line in template.lines() {
        match line.split_once("(*$").and_then(|(before, about)| Some((before, Only::named(about)?, about))) {
            None => text.push_str(line),
            Some((before, only, about)) if wanted.contains(&only) => text.push_str(&unmarked(before, about)),
            Some(_) => continue,
        }
        text.push('\n');
    }
    text
}

/// A line without its mark; what the mark says about it stays.
fn unmarked(before: &str, mark: &str) -> String {
    let about = mark.trim_start_matches(|one: char| one.is_ascii_alphabetic());
    let comment = if about == "*)" { String::new() } else { format!("(*{about}") };
    format!("{before}{comment}").trim_end().to_owned()
}

/// The template with the lines marked `kind` once for each of `every`, whose names are filled in.
pub(super) fn repeat(template: &str, kind: &str, every: &[Vec<(&str, String)>]) -> String {
    let mark = format!("(*${kind}");
    let mut text = String::with_capacity(template.len());
    for line in template.lines() {
        let Some((before, rest)) = line.split_once(&mark).filter(|(_, rest)| rest.starts_with([' ', '*'])) else {
            text = text + line + "\n";
            continue;
        };
        for names in every {
            text = text + &fill(&unmarked(before, rest), names) + "\n";
        }
    }
    text
}

/// The template with every token that is one of `names` written as its text says; comments stay.
pub(super) fn fill(template: &str, names: &[(&str, String)]) -> String {
    fill_with(template, &|written| names.iter().find(|(name, _)| *name == written).map(|(_, new)| new.clone()))
}

/// The template with every token for which `name` has another text; comments stay.
pub(super) fn fill_with(template: &str, name: &dyn Fn(&str) -> Option<String>) -> String {
    filled(template, tokenize(template), name)
}

/// The same for a template in SCL, where names stand in quotes or behind `#`.
pub(super) fn fill_scl(template: &str, names: &[(&str, String)]) -> String {
    let name = |written: &str| names.iter().find(|(name, _)| *name == written).map(|(_, new)| new.clone());
    filled(template, tokenize_in(Dialect::SiemensScl, template), &name)
}

fn filled(template: &str, tokens: Vec<Token>, name: &dyn Fn(&str) -> Option<String>) -> String {
    let mut text = String::with_capacity(template.len());
    for token in tokens {
        let written = template.get(token.start as usize..token.end as usize).unwrap_or("");
        let new = if token.kind.is_trivia() { None } else { name(written) };
        text.push_str(new.as_deref().unwrap_or(written));
    }
    text
}

/// How a program knows its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    /// There is one instance of it.
    Fixed(usize),
    /// Each instance receives it from the configuration.
    OfInstance,
}

/// A controller's template for one of so many programs.
fn numbered(template: &str, number: Number, line: &str) -> String {
    let (number, wanted): (_, &[Only]) = match number {
        Number::Fixed(number) => (number.to_string(), &[]),
        Number::OfInstance => ("SDSP_Number".to_owned(), &[Only::Instances]),
    };
    fill(&lines_for(template, wanted), &[("SDSP_NUMBER", number), ("SDSP_LINE", line.to_owned())])
}

/// The part of a template between two of its lines.
fn between(text: &str, from: &str, to: &str) -> String {
    let rest = text.split_once(from).map_or("", |(_, rest)| rest);
    rest.split_once(to).map_or("", |(part, _)| part).trim_matches('\n').to_owned()
}

/// The execution controller of a program; `line` is the type of the line of programs.
pub(super) fn controller(number: Number, line: &str) -> Controller {
    let text = numbered(EXECUTION_CONTROLLER, number, line);
    Controller {
        declarations: between(&text, "PROGRAM SDSP_PROGRAM", "(* Body *)"),
        header: between(&text, "(* Body *)", "(* Regular program begins here *)"),
        footer: between(&text, "(* Footer *)", "END_PROGRAM"),
    }
}

/// The execution controller of an organization block; with `Only::Exchange` it gives outputs to the gateway's block.
pub(super) fn scl_controller(number: Number, wanted: &[Only]) -> Controller {
    let number = match number {
        Number::Fixed(number) => number,
        // Organization blocks have no instances.
        Number::OfInstance => 0,
    };
    let text = fill_scl(&lines_for(SCL_EXECUTION_CONTROLLER, wanted), &[("SDSP_NUMBER", number.to_string())]);
    Controller {
        declarations: between(&text, "(* Declarations *)", "(* Body *)"),
        header: between(&text, "(* Header *)", "(* Regular program begins here *)"),
        footer: between(&text, "(* Footer *)", "END_ORGANIZATION_BLOCK"),
    }
}

/// The execution controller of a program that is a chart.
pub(super) fn chart_controller(number: Number, line: &str) -> ChartController {
    let text = numbered(CHART_CONTROLLER, number, line);
    ChartController {
        declarations: between(&text, "PROGRAM SDSP_CHART", "(* Chart *)"),
        gate: between(&text, "(* Gate *)", "(* Condition *)").trim().to_owned(),
        header: between(&text, "(* Header *)", "(* Steps and actions begin here *)"),
        close: between(&text, "(* Steps and actions end here *)", "(* Footer *)"),
        footer: between(&text, "(* Footer *)", "(* End *)"),
    }
}

/// The parts of an execution controller of a chart.
pub(super) struct ChartController {
    pub(super) declarations: String,
    /// Before each condition, `AND` at its end.
    pub(super) gate: String,
    /// Before what the action of every step does.
    pub(super) header: String,
    pub(super) close: String,
    /// What ends a scan.
    pub(super) footer: String,
}

impl ChartController {
    /// The execution signal as an expression.
    pub(super) fn is_open(&self) -> &str {
        self.gate.strip_suffix("AND").unwrap_or(&self.gate).trim()
    }
}

/// The parts of an execution controller.
pub(super) struct Controller {
    pub(super) declarations: String,
    pub(super) header: String,
    /// What ends a program's turn: behind the body and before each RETURN.
    pub(super) footer: String,
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_iec::input::Input;
    use onescan_iec::input::kind::SourceKind;
    use onescan_iec::syntax::parser::parse_source;
    use onescan_iec::syntax::{FileId, parse};

    const ALL: [(&str, &str); 15] = [
        ("line", LINE),
        ("globals", GLOBALS),
        ("scheduler", SCHEDULER),
        ("event_scheduler", EVENT_SCHEDULER),
        ("follow", FOLLOW),
        ("execution_controller", EXECUTION_CONTROLLER),
        ("chart_controller", CHART_CONTROLLER),
        ("action_control", ACTION_CONTROL),
        ("step", STEP),
        ("elapsed", ELAPSED),
        ("on_delay", ON_DELAY),
        ("off_delay", OFF_DELAY),
        ("pulse", PULSE),
        ("real_time_clock", REAL_TIME_CLOCK),
        ("time_function", TIME_FUNCTION),
    ];

    #[test]
    fn every_source_says_what_it_is_and_parses_as_it_is() {
        for (name, text) in ALL {
            assert!(text.starts_with("(* ") && text.contains("Carlsson et al. 2012, sec. V-"), "{name}");
            assert_eq!(parse(FileId(0), text).diagnostics, [], "{name}");
            // XML need not escape anything of a controller.
            assert!(name != "execution_controller" || !text.contains(['<', '&', '>']));
        }
    }

    #[test]
    fn every_source_in_scl_does_too() {
        let all = [
            SCL_GLOBALS,
            SCL_EXCHANGE,
            SCL_SCHEDULER,
            SCL_EXECUTION_CONTROLLER,
            SCL_ON_DELAY,
            SCL_OFF_DELAY,
            SCL_PULSE,
        ];
        for text in all {
            assert!(text.starts_with("(* ") && text.contains("Carlsson et al. 2012, sec. V-"), "{text}");
            let input = Input::from_text("shim.scl", SourceKind::Text, text);
            assert_eq!(parse_source(FileId(0), input.file()).diagnostics, [], "{text}");
        }
    }

    #[test]
    fn names_are_filled_in_and_comments_are_not() {
        let filled = fill("(* N *) x := N + NN; (* N *)", &[("N", "3".to_owned())]);
        assert_eq!(filled, "(* N *) x := 3 + NN; (* N *)");
    }

    #[test]
    fn lines_for_ltime_come_and_go() {
        let template = "a\nb (*$ltime*)\nc (*$ltime about it *)\n";
        assert_eq!(lines_for(template, &[]), "a\n");
        assert_eq!(lines_for(template, &[Only::LongTime]), "a\nb\nc (* about it *)\n");
    }

    #[test]
    fn lines_are_repeated() {
        let names = |name: &str| vec![("X", name.to_owned())];
        let template = "a := X;\nX : BOOL; (*$each about X *)\nX; (*$eachof*)\n";
        assert_eq!(
            repeat(template, "each", &[names("b"), names("c")]),
            "a := X;\nb : BOOL; (* about X *)\nc : BOOL; (* about X *)\nX; (*$eachof*)\n"
        );
        assert_eq!(repeat(template, "each", &[]), "a := X;\nX; (*$eachof*)\n");
    }

    #[test]
    fn a_controller_of_a_chart_has_all_its_parts() {
        let controller = chart_controller(Number::Fixed(2), "SDSP_LINE");
        assert!(controller.declarations.contains("SDSP_Open : BOOL;") && controller.gate.ends_with(" AND"));
        assert!(controller.header.ends_with("SDSP_Begun := TRUE;") && controller.close.trim() == "END_IF;");
        assert!(controller.footer.ends_with("SDSP_Open := SDSP_Turn = 2;"), "{}", controller.footer);
    }

    #[test]
    fn a_controller_has_all_its_parts() {
        let controller = controller(Number::Fixed(2), "ARRAY [0..3] OF INT");
        assert!(controller.declarations.contains("ARRAY [0..3] OF INT"));
        assert!(controller.header.ends_with("NOT SDSP_Granted THEN RETURN; END_IF;"), "{}", controller.header);
        let footer: Vec<&str> = controller.footer.split_whitespace().collect();
        let counted = "IF SDSP_Next[2] = 0 THEN SDSP_Done := SDSP_Done + 1; END_IF;";
        let footer = footer.join(" ");
        assert_eq!(footer, format!("IF SDSP_Granted THEN {counted} SDSP_Turn := SDSP_Next[2]; END_IF;"));
        let controller = super::controller(Number::OfInstance, "SDSP_LINE");
        assert!(
            controller.declarations.contains("VAR_INPUT SDSP_Number : INT; END_VAR"),
            "{}",
            controller.declarations
        );
        assert!(controller.header.contains("SDSP_Turn = SDSP_Number;"));
    }
}
