//! What the PLC does before the first scan after a start, and before another start.

use crate::check::body::Body;
use crate::check::declare::declarations::Checker;
use crate::check::declare::start::{Occasion, Start, StartKind};
use crate::ir::{ElementaryType, Guard, Place, Pou, Storage};

impl Checker<'_> {
    /// What the PLC does at an occasion: global variables in the order of the text, then programs.
    pub(in crate::check) fn occasion(&mut self, occasion: Occasion) -> Option<Pou> {
        let mut all = std::mem::take(&mut self.started);
        all.sort_by_key(|each| (each.place.span.file, each.place.span.start));
        let programs = self.programs.clone();
        let mut body = Body::outside(self);
        let mut statements = Vec::new();
        for each in &all {
            statements.extend(body.performed(&each.place, &each.starts, occasion));
        }
        for program in programs {
            let span = body.checker.pou(program.pou).ast.name.span;
            let place = Place::whole(Storage::Absolute(program.offset), ElementaryType::Byte.into(), span);
            let kind = StartKind::Instance(program.pou, &[]);
            let start = Start { offset: 0, kind, span, home: None };
            statements.extend(body.performed(&place, &[start], occasion));
        }
        // What the configuration says goes before what declarations say.
        let values = std::mem::take(&mut body.checker.configured.values);
        for each in &values {
            statements.extend(body.performed(&each.place, &each.starts, occasion));
        }
        body.checker.configured.values = values;
        let registers = body.scope.registers;
        self.started = all;
        let span = statements.first()?.span;
        let name = match occasion {
            Occasion::Start => "PLC start",
            Occasion::End => "PLC end",
        };
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
