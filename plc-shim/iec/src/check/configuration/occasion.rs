//! What the PLC does before the first scan after a start, and before another start.

use super::Configurer;
use crate::check::body::Body;
use crate::check::declare::{Occasion, Start, StartKind};
use crate::ir::{ElementaryType, Guard, Place, Pou, Storage};

impl Configurer<'_, '_> {
    /// What the PLC does at a start: first values, then what wants all of them, then programs that it calls.
    pub(in crate::check) fn start(&mut self) -> Option<Pou> {
        self.occasions("PLC start", &[Occasion::Start, Occasion::AfterStart])
    }

    /// What the PLC does before another start.
    pub(in crate::check) fn end(&mut self) -> Option<Pou> {
        self.occasions("PLC end", &[Occasion::End])
    }

    /// What the PLC does at each occasion: global variables in the order of the text, then programs.
    fn occasions(&mut self, name: &str, occasions: &[Occasion]) -> Option<Pou> {
        let globals = self.declarations.started();
        let programs = self.declarations.programs().to_vec();
        let mut body = Body::outside(self.declarations);
        let mut statements = Vec::new();
        for occasion in occasions.iter().copied() {
            for each in &globals {
                statements.extend(body.performed(&each.place, &each.starts, occasion));
            }
            for program in &programs {
                let span = body.declarations().pou(program.pou).ast().name.span;
                let place = Place::whole(Storage::Absolute(program.offset), ElementaryType::Byte.into(), span);
                let kind = StartKind::Instance(program.pou, &[]);
                let start = Start { offset: 0, kind, span, home: None, within: None };
                statements.extend(body.performed(&place, &[start], occasion));
            }
            // What the configuration says takes precedence over what declarations say, so it comes last.
            for each in &self.configured.values {
                statements.extend(body.performed(&each.place, &each.starts, occasion));
            }
        }
        if occasions.contains(&Occasion::AfterStart) {
            for program in programs.iter().filter(|program| program.runs_at_start) {
                statements.push(body.program_at_start(program.pou, program.offset));
            }
        }
        let registers = body.into_scope().into_registers();
        let span = statements.first()?.span;
        Some(Pou {
            name: name.to_owned(),
            span,
            variables: Vec::new(),
            registers,
            parameters: 0,
            result: None,
            guard: Guard::None,
            body: statements,
        })
    }
}
