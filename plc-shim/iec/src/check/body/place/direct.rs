//! Direct addresses in statements (2nd ed. 2.4.1.1).

use super::{Access, Located, is_machine_input};
use crate::check::body::Body;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Place, Storage};
use crate::syntax::Span;
use crate::syntax::direct_address::{Area, DirectAddress};

impl Body<'_, '_> {
    /// The place that a direct address in a statement stands for.
    pub(in crate::check) fn direct_place(&mut self, text: &str, span: Span) -> Option<Located> {
        if DirectAddress::is_hierarchical(text) {
            return self.hierarchical(text, span);
        }
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

    /// `%IW2.5.7.1`
    fn hierarchical(&mut self, text: &str, span: Span) -> Option<Located> {
        let (area, width) = match DirectAddress::parse_hierarchical(text) {
            Ok(found) => found,
            Err(error) => return self.declarations.invalid_address(text, error, span),
        };
        let ty = width.bit_string();
        let offset = self.declarations.hierarchical_place(text, ty.size(), span)?;
        let access = if area == Area::Input { Access::MachineInput } else { Access::ReadWrite };
        Some(Located { place: Place::whole(Storage::Absolute(offset), ty.into(), span), access })
    }
}
