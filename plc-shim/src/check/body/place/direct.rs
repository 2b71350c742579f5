//! Direct addresses in statements (2nd ed. 2.4.1.1).

use super::{Access, Located, is_machine_input};
use crate::check::body::Body;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Place, Storage};
use crate::syntax::Span;

impl Body<'_, '_> {
    /// The place that a direct address in a statement stands for.
    pub(in crate::check) fn direct_place(&mut self, text: &str, span: Span) -> Option<Located> {
        let (address, location) = self.declarations.direct_address(text, span)?;
        let Some(location) = location else {
            let message = format!("`{text}` is open, so it stands in declarations only");
            self.report(Diagnostic::error(Code::InvalidAddress, span, message));
            return None;
        };
        let ty = address.width.bit_string();
        self.declarations.use_area(location, ty.size());
        let storage = Storage::Located(location);
        let access = if is_machine_input(storage) { Access::MachineInput } else { Access::ReadWrite };
        Some(Located { place: Place::whole(storage, ty.into(), span), access })
    }
}
