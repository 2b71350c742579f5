//! The dialects as data.

use super::Dialect::{self, Codesys, Iec2, Iec3, Matiec, SiemensScl, TwinCat};
use super::{
    ActionPulses, AddressUnit, Behaviour, BeyondSubrange, DivisionByZero, Feature, IntegerWidth, LongTime, Selection,
    StringMemory, Ties, TimeRange, Truth,
};

/// Who has a construct, and where that is written.
#[derive(Debug, Clone, Copy)]
pub struct FeatureRow {
    pub feature: Feature,
    /// The dialects that have it.
    pub dialects: &'static [Dialect],
    /// Where it is written.
    pub source: &'static str,
}

const fn row(feature: Feature, dialects: &'static [Dialect], source: &'static str) -> FeatureRow {
    FeatureRow { feature, dialects, source }
}

/// Every construct that some dialects have and others do not, in the order of [`Feature::ALL`].
pub const FEATURES: &[FeatureRow] = &[
    row(Feature::NestedComments, &[Iec3, Codesys, TwinCat, SiemensScl], "2nd ed. 2.1.5; 3rd ed. 6.1.5"),
    row(Feature::LineComments, &[Iec3, Codesys, TwinCat, SiemensScl], "3rd ed. Table 3"),
    row(Feature::StarComments, &[Iec3, SiemensScl], "3rd ed. Table 3; CODESYS and TwinCAT: Comments"),
    row(Feature::Continue, &[Iec3, Codesys, TwinCat, SiemensScl], "3rd ed. Table 72.9"),
    row(Feature::Power, &[Iec2, Iec3, SiemensScl, Matiec], "2nd ed. Table 52; CODESYS and TwinCAT: EXPT instead"),
    row(Feature::LooseEnds, &[Codesys, TwinCat], "CODESYS: ST statements; TwinCAT: ST instructions"),
    row(Feature::ShortCircuit, &[Codesys, TwinCat], "CODESYS and TwinCAT: operators AND_THEN, OR_ELSE"),
    row(Feature::SetReset, &[Codesys, TwinCat], "CODESYS and TwinCAT: ExST assignments S= and R="),
    row(Feature::ChainedAssignment, &[Codesys, TwinCat, SiemensScl], "CODESYS: ExST; TIA Portal: value assignments"),
    row(Feature::CompoundAssignment, &[SiemensScl], "TIA Portal: combined value assignments"),
    row(
        Feature::BareArrayValues,
        &[Codesys, TwinCat, SiemensScl],
        "CODESYS V2.3 and TwinCAT 2: ARRAY; S7-SCL V5.3: 8.4",
    ),
    row(Feature::ConditionalPragmas, &[Codesys, TwinCat], "CODESYS and TwinCAT: conditional pragmas"),
    row(Feature::ControlParts, &[Codesys, TwinCat], "CODESYS: ST instruction FOR; TwinCAT: ST instruction FOR"),
    row(Feature::Jumps, &[Codesys, TwinCat, SiemensScl], "CODESYS, TwinCAT: ST instruction JMP; TIA Portal: GOTO"),
    row(Feature::StaticSection, &[Codesys, TwinCat], "CODESYS and TwinCAT: VAR_STAT"),
    row(Feature::InstanceSection, &[Codesys, TwinCat], "CODESYS and TwinCAT: VAR_INST"),
    row(Feature::FleetingInstances, &[Codesys, TwinCat], "CODESYS and TwinCAT: VAR of methods and functions"),
    row(Feature::InitArguments, &[Codesys, TwinCat], "CODESYS and TwinCAT: methods FB_init, FB_reinit, FB_exit"),
    row(Feature::ComputedInitialValues, &[Codesys, TwinCat], "CODESYS and TwinCAT: initialization of variables"),
    row(Feature::BitArithmetic, &[Codesys, TwinCat], "CODESYS and TwinCAT: integer data types list BYTE to LWORD"),
    row(Feature::EnumerationsAsIntegers, &[Codesys, TwinCat], "CODESYS and TwinCAT: enumerations that are not strict"),
    row(
        Feature::NamedValues,
        &[Iec3, Codesys, TwinCat],
        "3rd ed. 6.4.4.3; CODESYS and TwinCAT: enumerations that are not strict",
    ),
    row(Feature::SignChange, &[Codesys, TwinCat], "CODESYS and TwinCAT: implicit conversion, a warning only"),
    row(Feature::LossyReals, &[Codesys, TwinCat], "CODESYS and TwinCAT: implicit conversion, a warning only"),
    row(
        Feature::CharactersAsBytes,
        &[Codesys, TwinCat],
        "CODESYS and TwinCAT: STRING, index access; else 3rd ed. 6.4.2.2",
    ),
    row(Feature::VendorParameters, &[Codesys, TwinCat], "CODESYS: library Standard; TwinCAT: Tc2_Standard"),
    row(
        Feature::Variants,
        &[SiemensScl],
        "TIA Portal: VARIANT; a source declares it in VAR_INPUT and VAR_IN_OUT here, not in VAR_OUTPUT or VAR_TEMP",
    ),
    row(
        Feature::GenericInputs,
        &[Codesys, TwinCat, SiemensScl],
        "CODESYS and TwinCAT: data types ANY and `ANY_<type>`; S7-SCL V5.3: parameter type ANY, of VAR_INPUT here",
    ),
    row(Feature::IntegerShifts, &[Codesys, TwinCat, SiemensScl], "CODESYS V2.3, TwinCAT 2: SHR; TIA Portal: SHR, ROR"),
    row(Feature::ClockFunctions, &[Codesys, TwinCat], "CODESYS and TwinCAT: operators TIME, LTIME"),
    row(
        Feature::OwnStandardBlocks,
        &[Codesys, TwinCat, Matiec],
        "CODESYS and TwinCAT: a project's own objects go before those of libraries; Beremiz: its library files declare them",
    ),
    row(Feature::QuotedNames, &[SiemensScl], "S7-1200 System Manual: SCL, addressing of tags"),
    row(Feature::Blocks, &[SiemensScl], "TIA Portal: external source files, SCL"),
    row(
        Feature::InstanceInternals,
        &[SiemensScl, Matiec],
        "TIA Portal: addressing instance data blocks; MatIEC: accepts it",
    ),
    row(
        Feature::BitsAsReals,
        &[Iec2, Codesys, TwinCat, Matiec],
        "2nd ed. Table 22; CODESYS and TwinCAT: type conversions; 3rd ed. Table 25 transfers bits",
    ),
    row(
        Feature::EmptyArguments,
        &[Codesys, TwinCat],
        "CODESYS and TwinCAT: calling a function block, as its editor completes it",
    ),
    row(Feature::WindowsCharacters, &[Codesys, TwinCat], "CODESYS and TwinCAT: data type STRING"),
    row(
        Feature::LeftOutInputs,
        &[Iec3, Codesys, TwinCat],
        "CODESYS and TwinCAT: FUNCTION, optional inputs; SIMATIC AX: accepts it, as public projects show",
    ),
    row(Feature::LooseStrings, &[Codesys, TwinCat], "CODESYS and TwinCAT: VAR_IN_OUT, strings"),
    row(Feature::DoubleQuotes, &[Matiec], "OpenPLC's editor, initial values"),
    row(
        Feature::LooseWidths,
        &[Codesys, TwinCat, Matiec],
        "MatIEC: accepts it; TwinCAT: accepts it, as public projects show",
    ),
    row(
        Feature::OwnStandardFunctions,
        &[Codesys, TwinCat, Matiec],
        "CODESYS and TwinCAT: rules for identifiers, keywords alone; MatIEC: overloaded functions",
    ),
    row(
        Feature::InstanceCopies,
        &[Iec3, Codesys, TwinCat],
        "CODESYS and TwinCAT: assignment of instances, a copy; SIMATIC AX: accepts it, as public projects show, here with a warning",
    ),
    row(
        Feature::ReadableInternals,
        &[Codesys, TwinCat, SiemensScl, Matiec],
        "CODESYS: VAR, local variables; TwinCAT: local variables; TIA Portal: addressing instance data blocks; MatIEC: accepts it",
    ),
    row(Feature::ProgramInstances, &[Codesys, TwinCat], "CODESYS and TwinCAT: object PROGRAM, calling a program"),
    row(Feature::DynamicMemory, &[Codesys, TwinCat], "CODESYS and TwinCAT: operators __NEW, __DELETE"),
    row(Feature::AssignedValues, &[Codesys, TwinCat], "CODESYS and TwinCAT: assignment as expression"),
    row(Feature::ReadableInOuts, &[Matiec], "MatIEC: calls of blocks, copies it in and out; here it is not copied"),
    row(Feature::ConditionalReturns, &[Codesys, TwinCat], "CODESYS: ST statement RETURN; TwinCAT: accepts it"),
    row(Feature::LooseLast, &[SiemensScl], "S7-SCL: accepts it, as sources of PCS 7 show"),
    row(Feature::DbSpecific, &[SiemensScl], "TIA Portal: exported sources, retain set in the instance data block"),
    row(Feature::UntypedConstants, &[SiemensScl], "S7-SCL V5.3: constants"),
    row(Feature::AlikeStructures, &[SiemensScl], "S7-SCL V5.3: value assignments with structures"),
    row(
        Feature::IntegersAsReals,
        &[Codesys, TwinCat, SiemensScl],
        "CODESYS and TwinCAT: implicit conversion, a warning only; S7-SCL V5.3: implicit conversions",
    ),
    row(
        Feature::ValuesByContext,
        &[Iec3, Codesys, TwinCat],
        "3rd ed. 6.4.4.2, an error if nothing says which is meant; CODESYS and TwinCAT: enumerations",
    ),
    row(Feature::ValueStatements, &[Codesys, TwinCat], "CODESYS and TwinCAT: compile it, with a warning"),
    row(Feature::Exceptions, &[Codesys, TwinCat], "CODESYS and TwinCAT: operators __TRY, __CATCH, __FINALLY, __ENDTRY"),
    row(Feature::ShortPrefixes, &[SiemensScl], "TIA Portal: constants; S7-SCL V5.3: 7.4"),
    row(Feature::DivOperator, &[SiemensScl], "S7-SCL V5.3: 10.3"),
    row(
        Feature::Recursion,
        &[Codesys, TwinCat],
        "CODESYS: attribute estimated-stack-usage, recursive calls; TwinCAT: accepts it, as projects show",
    ),
    row(Feature::RepeatedArguments, &[Codesys, TwinCat], "TwinCAT: accepts it, as public projects show"),
    row(Feature::EmptyArrays, &[Codesys, TwinCat], "TwinCAT: accepts it, as public projects show"),
    row(Feature::LooseUnderscores, &[TwinCat], "TwinCAT: accepts it, as public projects show"),
    row(Feature::Views, &[SiemensScl], "S7-SCL V5.3: declaration of views; TIA Portal: overlaying tags with AT"),
    row(Feature::ElseColon, &[SiemensScl], "S7-SCL V5.3: CASE statement"),
    row(
        Feature::LooseParts,
        &[Codesys, TwinCat],
        "CODESYS and TwinCAT: bit access in variables, of integers; accept it, as public projects show",
    ),
    row(Feature::OutputsHandedOn, &[Codesys, TwinCat], "TwinCAT: accepts it, as public projects show"),
    row(Feature::EmptyBases, &[Codesys, TwinCat], "TwinCAT: accepts it, as public projects show"),
    row(
        Feature::ShiftedLiterals,
        &[Codesys, TwinCat],
        "CODESYS and TwinCAT: SHL, \"the number of bits for the arithmetic operation is given by the data type of the input\"; constants, the smallest type",
    ),
    row(
        Feature::IntegerParts,
        &[Iec3, SiemensScl],
        "S7-1200 System Manual: accessing a slice of a tag; SIMATIC AX: accepts it; 3rd ed. Table 17, bit strings alone",
    ),
    row(Feature::LoneOutputs, &[Iec3, SiemensScl], "TIA Portal: calling functions, a block with one parameter"),
    row(Feature::ProgramInOuts, &[Matiec], "MatIEC: accepts it; CODESYS and TwinCAT: for programs that others call"),
    row(
        Feature::CCode,
        &[Matiec],
        "Beremiz: C code between braces, GetFbVar and SetFbVar; done elsewhere, as a stub is",
    ),
    row(Feature::GenericConstants, &[Codesys, TwinCat], "CODESYS and TwinCAT: VAR_GENERIC CONSTANT"),
    row(Feature::DecimalBase, &[Codesys, TwinCat], "TwinCAT: accepts it, as public projects show"),
    row(Feature::BaseParts, &[Codesys, TwinCat], "TwinCAT: accepts it, as public projects show"),
    row(Feature::GlobalOperator, &[Codesys, TwinCat], "CODESYS: global namespace operator; TwinCAT: Global Namespace"),
    row(
        Feature::PlacesOfText,
        &[Codesys, TwinCat],
        "CODESYS: operators __POUNAME, __POSITION, __VARINFO; TwinCAT: operator __VARINFO; accepts the others, as public projects show",
    ),
    row(Feature::BitsInOut, &[Codesys, TwinCat], "TwinCAT: accepts it, as public projects show"),
    row(
        Feature::EmptyLists,
        &[Iec3, Codesys, TwinCat],
        "SIMATIC AX: accepts it, as public projects show; CODESYS and TwinCAT: FUNCTION, optional inputs",
    ),
    row(Feature::NamedCounts, &[Codesys, TwinCat], "TwinCAT: accepts it, as public projects show"),
    row(Feature::CharactersAsText, &[Iec3], "3rd ed. Figures 11 and 12"),
    row(Feature::PositionalOutputs, &[Iec3], "SIMATIC AX: accepts them, as public projects show"),
    row(Feature::CharactersSelect, &[Iec3], "3rd ed. 7.3.3.3.3: the selector is of an elementary type"),
    row(
        Feature::BareCalls,
        &[Iec3],
        "3rd ed. 6.6.1.4.2, a formal list that leaves out all; SIMATIC AX: accepts it, as public projects show",
    ),
    row(Feature::Overloads, &[Iec3], "SIMATIC AX: overloads, as public projects show; not in 3rd ed."),
    row(
        Feature::UnusedUnits,
        &[Codesys, TwinCat],
        "TwinCAT: commands Build PLC project, Check all objects; CODESYS: command Check all Application Objects",
    ),
    row(Feature::ThisPointer, &[Codesys, TwinCat], "CODESYS and TwinCAT: pointer THIS"),
    row(Feature::LiteralAddresses, &[Codesys, TwinCat], "CODESYS: accepts it, as public projects show"),
    row(
        Feature::TimesBesideNumbers,
        &[SiemensScl],
        "TIA Portal: implicit conversion of DInt to Time, without IEC check",
    ),
    row(
        Feature::TimesAsDates,
        &[Codesys, TwinCat],
        "CODESYS: operators TIME_TO, DATE_TO, BOOL_TO; TwinCAT: conversions of TIME, DATE, BOOL",
    ),
    row(
        Feature::FreeTasks,
        &[Iec3, Codesys, TwinCat],
        "CODESYS: object Task, freewheeling; SIMATIC AX: the program cycle, as public projects show, here with a warning",
    ),
    row(Feature::PointersInOut, &[Codesys, TwinCat], "TwinCAT: accepts it, as public projects show"),
    row(Feature::OpenInputsHandedOn, &[Codesys, TwinCat], "CODESYS: accepts it, as public projects show"),
    row(Feature::LongTimers, &[Iec3], "3rd ed. Table 46: TP, TON and TOF are overloaded for TIME and LTIME"),
    row(Feature::WideStarts, &[Iec3], "SIMATIC AX: accepts it, as public projects show, here with a warning"),
    row(Feature::SpacedValues, &[Iec3], "SIMATIC AX: accepts it, as public projects show"),
    row(Feature::NarrowQuotes, &[Iec3], "SIMATIC AX: accepts it, as public projects show"),
    row(
        Feature::GlobalConfigurations,
        &[Iec3],
        "SIMATIC AX: hardware identifiers and addresses have files of their own",
    ),
    row(
        Feature::ImplicitInit,
        &[Codesys, TwinCat],
        "CODESYS and TwinCAT: FB_init, \"is always implicitly available\", the standard initialization",
    ),
];

/// How a dialect behaves, and where that is written.
#[derive(Debug, Clone, Copy)]
pub struct BehaviourRow {
    pub dialect: Dialect,
    pub behaviour: Behaviour,
    /// Where each of it is written, in the order of the fields.
    pub sources: [&'static str; 15],
}

/// What the standard says, or README.md where it leaves a choice.
pub const STANDARD: Behaviour = Behaviour {
    string_length: 80,
    time: TimeRange::Nanoseconds64,
    ties: Ties::Even,
    division_by_zero: DivisionByZero::Fault,
    address_unit: AddressUnit::Element,
    negates_powers: false,
    truth: Truth::LowestBit,
    time_number_ns: 1_000_000,
    strings: StringMemory::Counted,
    beyond_subrange: BeyondSubrange::Fault,
    long_time: LongTime::Signed64,
    selection: Selection::All,
    integers: IntegerWidth::Own,
    action_pulses: ActionPulses::OfAction,
    text_functions: None,
};

const STANDARD_SOURCES: [&str; 15] = [
    "left open by 2nd ed. 2.3.1",
    "left open by 2nd ed. 2.2.3",
    "2nd ed. 2.5.1.5.1, IEC 60559",
    "2nd ed. Annex E",
    "left open by 2nd ed. 2.4.1.1",
    "2nd ed. B.3.1, 3rd ed. Table 71",
    "2nd ed. 2.5.1.5.1",
    "left open by 2nd ed. 2.5.1.5.1",
    "left open by 2nd ed. 2.3.1",
    "2nd ed. Annex E",
    "3rd ed. Table 10",
    "2nd ed. 2.5.1.4, a function's inputs",
    "2nd ed. 2.5.1.5.2, a result of the operands' type",
    "2nd ed. 2.6.4.5, Figure 15; 3rd ed. 6.7.4.6",
    "2nd ed. Table 29",
];

/// How the dialects behave.
pub const BEHAVIOURS: &[BehaviourRow] = &[
    BehaviourRow { dialect: Iec2, behaviour: STANDARD, sources: STANDARD_SOURCES },
    BehaviourRow { dialect: Iec3, behaviour: STANDARD, sources: STANDARD_SOURCES },
    BehaviourRow {
        dialect: Codesys,
        behaviour: Behaviour {
            time: TimeRange::Unsigned32,
            truth: Truth::NotZero,
            strings: StringMemory::ZeroTerminated,
            beyond_subrange: BeyondSubrange::Assign,
            long_time: LongTime::Unsigned64,
            selection: Selection::Selected,
            integers: IntegerWidth::Register,
            text_functions: Some(255),
            ..STANDARD
        },
        sources: [
            "CODESYS: data type STRING",
            "CODESYS: data type TIME",
            "CODESYS: conversion REAL, LREAL",
            "CODESYS: operator DIV",
            "CODESYS: addresses",
            "CODESYS: EXPT, no operator",
            "CODESYS: operator TO_BOOL",
            "CODESYS: operator TIME_TO",
            "CODESYS: data type STRING",
            "CODESYS: POU CheckRangeSigned; without it no check",
            "CODESYS: data type LTIME",
            "CODESYS: operator SEL",
            "CODESYS: operators, overflow and underflow in the data type; SA0066",
            "CODESYS: SFC, IEC actions, one control for an action; not tried on the tool",
            "CODESYS: library Standard, CONCAT, LEN",
        ],
    },
    BehaviourRow {
        dialect: TwinCat,
        behaviour: Behaviour {
            time: TimeRange::Unsigned32,
            ties: Ties::Away,
            address_unit: AddressUnit::Byte,
            truth: Truth::NotZero,
            strings: StringMemory::ZeroTerminated,
            beyond_subrange: BeyondSubrange::Assign,
            long_time: LongTime::Unsigned64,
            selection: Selection::Selected,
            integers: IntegerWidth::Register,
            text_functions: Some(255),
            ..STANDARD
        },
        sources: [
            "TwinCAT: STRING",
            "TwinCAT: TIME/LTIME",
            "TwinCAT: floating point number conversion",
            "TwinCAT: operator DIV",
            "TwinCAT: addresses",
            "TwinCAT: EXPT, no operator",
            "TwinCAT: TO_BOOL",
            "TwinCAT: TIME_TO",
            "TwinCAT: STRING",
            "TwinCAT: subrange types; POU CheckRangeSigned checks",
            "TwinCAT: TIME/LTIME",
            "TwinCAT: SEL",
            "TwinCAT: operators, overflow and underflow in the data type; SA0066",
            "TwinCAT: SFC, IEC actions, one control for an action; not tried on the tool",
            "TwinCAT: Tc2_Standard, CONCAT, LEN; Tc2_System, T_MaxString",
        ],
    },
    BehaviourRow {
        dialect: SiemensScl,
        behaviour: Behaviour {
            string_length: 254,
            time: TimeRange::Signed32,
            division_by_zero: DivisionByZero::Continue,
            address_unit: AddressUnit::Byte,
            negates_powers: true,
            ..STANDARD
        },
        sources: [
            "S7-1200 System Manual: data types, String",
            "S7-1200 System Manual: data types, Time",
            "S7-1200 System Manual: CONV, round to even",
            "S7-1200 System Manual: ENO of add, subtract, multiply, divide",
            "S7-1200 System Manual: accessing data",
            "S7-1200 System Manual: SCL, order of operators",
            "S7-1200 System Manual: CONV",
            "S7-1200 System Manual: data types, Time",
            "S7-1200 System Manual: data types, String; here its two counts are one",
            "2nd ed. Annex E; SCL has no subranges",
            "S7-1500: data types, LTIME",
            "left open by the S7-1200 System Manual",
            "S7-1200 System Manual: ADD, overflow sets ENO",
            "SCL has no charts",
            "S7-1200 System Manual: strings, as long as the output's",
        ],
    },
    BehaviourRow {
        dialect: Matiec,
        behaviour: Behaviour {
            truth: Truth::NotZero,
            time_number_ns: 1_000_000_000,
            action_pulses: ActionPulses::OfStep,
            ..STANDARD
        },
        sources: [
            "left open by 2nd ed. 2.3.1",
            "left open by 2nd ed. 2.2.3",
            "2nd ed. 2.5.1.5.1, IEC 60559",
            "2nd ed. Annex E",
            "left open by 2nd ed. 2.4.1.1",
            "2nd ed. B.3.1",
            "MatIEC: iec_std_functions, to_bool",
            "MatIEC: iec_std_lib, TIME_TO_REAL",
            "left open by 2nd ed. 2.3.1",
            "2nd ed. Annex E",
            "it has none; as 3rd ed. Table 10",
            "2nd ed. 2.5.1.4, a function's inputs",
            "MatIEC: iec_std_functions, a macro for each type",
            "MatIEC: the code that it makes of charts, tried",
            "2nd ed. Table 29",
        ],
    },
];
