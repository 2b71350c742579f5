//! Unions of vendors: members that share their bytes.

use std::sync::Arc;

use super::Written;
use crate::check::declare::{Need, TypedImage, align_up};
use crate::ir::{Field, TypeId};
use crate::syntax::{Span, ast};

impl<'a> Written<'_, 'a> {
    /// Every member begins where the union does. It begins with the first member's value, then with those
    /// that are given, the last one above the others.
    pub(super) fn union(
        &mut self,
        name: &str,
        (reserved, packing): (Option<TypeId>, Option<u32>),
        ast: &'a [ast::Field],
        span: Span,
    ) -> Option<TypedImage<'a>> {
        let mut fields: Vec<Field> = Vec::new();
        let mut images: Vec<(bool, Arc<[u8]>)> = Vec::new();
        let mut starts = Vec::new();
        let mut sound = true;
        for field in ast {
            if fields.iter().any(|other| other.name.eq_ignore_ascii_case(&field.name.text)) {
                self.declarations_mut().report_duplicate(&field.name, None);
                continue;
            }
            // The members behind a wrong one are looked at, too.
            let Some(resolved) = self.shared_member(field) else {
                sound = false;
                continue;
            };
            let bit = self.is_bit(field).then_some(0);
            fields.push(Field { name: field.name.text.clone(), ty: resolved.ty, offset: 0, bit, open: None });
            let counts = field.initial.is_some() || images.is_empty();
            if counts {
                starts.extend(resolved.starts.iter().cloned());
            }
            images.push((counts, resolved.image));
        }
        if !sound {
            return None;
        }
        let size = images.iter().map(|(_, image)| image.len()).max().unwrap_or(0).max(1) as u32;
        let align = self.declarations().types().structure_align(&fields, packing);
        self.declarations_mut().charge_image(u64::from(size), span)?;
        let mut image = vec![0; align_up(size, align) as usize];
        for (_, bytes) in images.iter().filter(|(counts, _)| *counts) {
            image.iter_mut().zip(bytes.iter()).for_each(|(target, source)| *target = *source);
        }
        let image: Arc<[u8]> = image.into();
        let ty = reserved.unwrap_or_else(|| self.declarations_mut().types_mut().structure(name.to_owned()));
        self.declarations_mut().types_mut().complete_structure(ty, fields, align, image.clone());
        Some(TypedImage { ty, image, starts: starts.into() })
    }

    fn shared_member(&mut self, field: &'a ast::Field) -> Option<TypedImage<'a>> {
        let resolved = self.resolve(&field.spec, Need::Size)?;
        self.body.reject_open_array(resolved.ty, field.spec.span)?;
        match &field.initial {
            Some(initial) => self.with_initial(&resolved, initial),
            None => Some(resolved),
        }
    }
}
