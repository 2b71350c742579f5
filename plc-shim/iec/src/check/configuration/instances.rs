//! `VAR_CONFIG` and `VAR_ACCESS` (2nd ed. 2.7.1, 2.4.3; Table 49 features 10 and 11).

use super::{Configurer, connections};
use crate::check::declare::{Need, Started, TypedImage};
use crate::check::resolve::Written;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Access, Storage, Target};
use crate::syntax::Span;
use crate::syntax::ast::{AccessDirection, AccessPath, InstanceValue, TypeSpec};

impl<'a> Configurer<'_, 'a> {
    /// Gives variables of single instances initial values of their own.
    pub(super) fn instance_values(&mut self, values: &'a [InstanceValue]) {
        for value in values {
            self.instance_value(value);
        }
    }

    fn instance_value(&mut self, value: &'a InstanceValue) -> Option<()> {
        let target = self.target(&value.path, None)?;
        let variable = target.variable.as_ref();
        if variable.is_none_or(|variable| variable.is_constant) {
            let what = if variable.is_some() { "a constant" } else { "a program" };
            let why = format!("is {what}, which has no value of its own in an instance");
            return self.unsuitable_value(&target, &why, value);
        }
        self.same_type(&target, &value.spec, value.path.span)?;
        if let Some(address) = &value.address {
            self.locate(&target, address)?;
        }
        if let Some(initial) = &value.initial {
            // What is not mentioned keeps the value that its own declaration gives.
            let image = self.declarations.image_at(target.inside, self.declarations.types().size(target.ty));
            let mut written = Written::outside(self.declarations);
            let TypedImage { image, starts, .. } =
                written.with_initial(&TypedImage::plain(target.ty, image.into()), initial)?;
            if !matches!(target.storage, Storage::Absolute(_)) {
                return self.unsuitable_value(
                    &target,
                    "has a direct address, where its declaration gives the value",
                    value,
                );
            }
            self.declarations.place(target.inside, image);
            let place = connections::place(&target, value.path.span);
            self.configured.values.push(Started { place, starts });
        }
        Some(())
    }

    fn unsuitable_value<T>(&mut self, target: &Target, why: &str, value: &InstanceValue) -> Option<T> {
        let message = format!("`{}` {why}", target.path);
        self.declarations.report(Diagnostic::error(Code::NoInstanceValue, value.path.span, message));
        None
    }

    fn same_type(&mut self, target: &Target, spec: &'a TypeSpec, span: Span) -> Option<()> {
        let declared = Written::outside(self.declarations).resolve(spec, Need::Size)?;
        if declared.ty != target.ty {
            let (wanted, found) =
                (self.declarations.types().name(target.ty), self.declarations.types().name(declared.ty));
            let message = format!("`{}` is {wanted} where it is declared, {found} here", target.path);
            let mut report = Diagnostic::error(Code::TypeMismatch, span, message);
            if let Some(variable) = &target.variable {
                report = report.with_label(variable.span, "declared here");
            }
            self.declarations.report(report);
            return None;
        }
        Some(())
    }

    /// Names for those outside.
    pub(super) fn access_paths(&mut self, paths: &'a [AccessPath]) {
        self.declarations.report_twins(&paths.iter().map(|access| &access.name).collect::<Vec<_>>());
        for access in paths {
            if let Some(found) = self.access_path(access) {
                self.configured.access.push(found);
            }
        }
    }

    fn access_path(&mut self, access: &'a AccessPath) -> Option<Access> {
        let target = self.target(&access.path, None)?;
        self.same_type(&target, &access.spec, access.path.span)?;
        let constant = target.variable.as_ref().is_none_or(|variable| variable.is_constant);
        let writable = access.direction == AccessDirection::ReadWrite;
        if writable && constant {
            let message = format!("`{}` is a constant, which is READ_ONLY", target.path);
            self.declarations.report(Diagnostic::error(Code::AssignToConstant, access.path.span, message));
            return None;
        }
        Some(Access { name: access.name.text.clone(), target, writable })
    }
}
