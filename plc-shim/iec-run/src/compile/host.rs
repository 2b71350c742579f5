//! Functions that WebAssembly lacks, given by the host from `libm`, so that every machine
//! computes the same bits.

use onescan_iec::ir::Intrinsic;

/// Module name of the imports.
pub(crate) const MODULE: &str = "libm";

/// A function of one REAL or LREAL, or of two.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Function {
    Single(fn(f32) -> f32),
    Double(fn(f64) -> f64),
    SinglePair(fn(f32, f32) -> f32),
    DoublePair(fn(f64, f64) -> f64),
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Import {
    pub(crate) name: &'static str,
    pub(crate) intrinsic: Intrinsic,
    pub(crate) function: Function,
}

const fn import(name: &'static str, intrinsic: Intrinsic, function: Function) -> Import {
    Import { name, intrinsic, function }
}

/// All imports; their position is their function index.
pub(crate) const IMPORTS: [Import; 22] = [
    import("logf", Intrinsic::Ln, Function::Single(libm::logf)),
    import("log", Intrinsic::Ln, Function::Double(libm::log)),
    import("log10f", Intrinsic::Log, Function::Single(libm::log10f)),
    import("log10", Intrinsic::Log, Function::Double(libm::log10)),
    import("expf", Intrinsic::Exp, Function::Single(libm::expf)),
    import("exp", Intrinsic::Exp, Function::Double(libm::exp)),
    import("sinf", Intrinsic::Sin, Function::Single(libm::sinf)),
    import("sin", Intrinsic::Sin, Function::Double(libm::sin)),
    import("cosf", Intrinsic::Cos, Function::Single(libm::cosf)),
    import("cos", Intrinsic::Cos, Function::Double(libm::cos)),
    import("tanf", Intrinsic::Tan, Function::Single(libm::tanf)),
    import("tan", Intrinsic::Tan, Function::Double(libm::tan)),
    import("asinf", Intrinsic::Asin, Function::Single(libm::asinf)),
    import("asin", Intrinsic::Asin, Function::Double(libm::asin)),
    import("acosf", Intrinsic::Acos, Function::Single(libm::acosf)),
    import("acos", Intrinsic::Acos, Function::Double(libm::acos)),
    import("atanf", Intrinsic::Atan, Function::Single(libm::atanf)),
    import("atan", Intrinsic::Atan, Function::Double(libm::atan)),
    import("atan2f", Intrinsic::Atan2, Function::SinglePair(libm::atan2f)),
    import("atan2", Intrinsic::Atan2, Function::DoublePair(libm::atan2)),
    import("powf", Intrinsic::Power, Function::SinglePair(libm::powf)),
    import("pow", Intrinsic::Power, Function::DoublePair(libm::pow)),
];

/// Function index of an intrinsic for REAL or LREAL, if the host gives it.
pub(crate) fn index(intrinsic: Intrinsic, single: bool) -> Option<u32> {
    let matches = |import: &Import| {
        let is_single = matches!(import.function, Function::Single(_) | Function::SinglePair(_));
        import.intrinsic == intrinsic && is_single == single
    };
    IMPORTS.iter().position(matches).map(|index| index as u32)
}
