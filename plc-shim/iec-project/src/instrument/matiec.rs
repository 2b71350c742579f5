//! A project in program text for MatIEC, which OpenPLC and Beremiz have: one text that holds all of it, with a
//! CONFIGURATION, and the gateway's variables at addresses. The project's files stay as they are.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::address::{Address, Room};
use super::exchanged::{Exchanged, Way};
use super::located::{Carrier, Located, WORDS, wanted};
use super::plain::Plain;
use super::survey::{Survey, survey};
use super::taken_over::{self, Handover};
use super::target::{Source as Own, Target};
use super::tasks::{Entry, Line, TaskTable, literal};
use super::{InstrumentError, Options, Project, attach, entries, marks, motion_use};
use crate::output::matiec::{self, Cycle, Globals, Unsaid};
use onescan_iec::diagnostic::{Code, Diagnostic, Severity};
use onescan_iec::dialect::Dialect;
use onescan_iec::input::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{CompilationUnit, Declaration, Pou, Section};
use onescan_iec::syntax::parser::parse_source;
use onescan_iec::syntax::{FileId, SourceFile, Span};
use onescan_iec::task_plan::Task;

/// The file that the tool takes.
const NAME: &str = "sdsp.st";

/// The project in one text with the shim attached.
pub(super) fn ported(plain: &Plain, options: &Options) -> Result<Project, InstrumentError> {
    let wrong = |findings| InstrumentError::Text(plain.diagnostics(findings));
    let units: Vec<_> = plain.sources.iter().map(|(id, file)| (id, parse_source(id, file))).collect();
    let mut findings = plain.findings.clone();
    findings.extend(units.iter().flat_map(|(_, parsed)| parsed.diagnostics.clone()));
    let trees: Vec<_> = units.iter().map(|(id, parsed)| (*id, &parsed.unit)).collect();
    let words = placed_words(&trees);
    let mut survey = survey(&trees, Target::Iec);
    findings.extend(survey.findings.drain(..).filter(|found| !words.iter().any(|word| word.is(found))));
    let motion = motion_use::motion(options.target, &trees, &survey.motion).findings;
    // What the shim does not replace is not there: MatIEC has no motion control.
    findings.extend(motion.into_iter().map(|found| Diagnostic { severity: Severity::Error, ..found }));
    if findings.iter().any(|found| found.severity == Severity::Error) {
        return Err(wrong(findings));
    }
    plain.refuse_singles(&survey)?;
    let tasks = plain.tasks(&survey, options)?;
    let table = TaskTable::new(&tasks, &entries(&survey), Line::Named)?;
    refuse_instances(&table).map_or(Ok(()), |found| Err(wrong(vec![found])))?;
    let merged = Merged::of(plain, &trees, &words)?;
    // What has no form is found in the project as it is, where it has a place that its author knows.
    matiec::lowered(&merged.text, merged.dialect).map_err(|unsaid| wrong(merged.diagnostics(unsaid)))?;
    let mut layout = Layout::new(&merged, &words, options).map_err(|text| wrong(vec![nowhere(&text)]))?;
    let text = layout.handed_over(&merged, &table, &survey, options).map_err(|text| wrong(vec![nowhere(&text)]))?;
    let behind = with_shim(&text, merged.dialect, &table, options)?;
    let lowered = matiec::lowered(&behind, merged.dialect).map_err(|unsaid| wrong(merged.own(unsaid)))?;
    let interval = options.cycle.unwrap_or(table.shortest);
    let cycle = Cycle { interval: literal(interval), programs: programs(&table) };
    let whole = matiec::assembled(&lowered.text, merged.dialect, &layout.addresses, &cycle);
    let mut files = plain.unchanged();
    plain.add_own(Own { name: NAME.to_owned(), text: format!("{}\n{whole}", marks::WHOLE) }, &mut files);
    let whole = files.last().map(|file| file.name.clone());
    plain.delete_stale(&mut files);
    let warnings = plain.diagnostics(findings);
    let task = Task {
        name: "Res0.SDSP_Cycle".to_owned(),
        interval: Some(interval),
        programs: cycle.programs.iter().map(|(instance, _)| format!("Res0.{instance}")).collect(),
        ..Task::default()
    };
    Ok(Project { whole, located: layout.located, tasks: Some(vec![task]), ..Project::of(files, warnings) })
}

/// The scheduler comes first, then the programs in the order of the line.
fn programs(table: &TaskTable<'_>) -> Vec<(String, String)> {
    let scheduler = ("SDSP".to_owned(), "SDSP_Scheduler".to_owned());
    let own = table.programs.iter().map(|entry| {
        let instance = entry.name.rsplit('.').next().unwrap_or(&entry.name);
        let program = &entry.pou.name.text;
        let is_program = instance.eq_ignore_ascii_case(program);
        let instance = if is_program { format!("Run_{program}") } else { instance.to_owned() };
        (instance, program.clone())
    });
    std::iter::once(scheduler).chain(own).collect()
}

/// A second instance of a program would need a number that the configuration gives it.
fn refuse_instances(table: &TaskTable<'_>) -> Option<Diagnostic> {
    let again = table
        .programs
        .iter()
        .enumerate()
        .find(|(at, entry)| table.programs.iter().take(*at).any(|other| std::ptr::eq(other.pou, entry.pou)));
    again.map(|(_, entry)| {
        let name = &entry.pou.name;
        let message = format!("several instances of program `{}` cannot be had in MatIEC", name.text);
        let help = "make it a function block, and write a program for each instance";
        Diagnostic::error(Code::UnsupportedFeature, name.span, message).with_help(help)
    })
}

/// The text with the shim, without its marks.
fn with_shim(
    text: &str,
    dialect: Dialect,
    table: &TaskTable<'_>,
    options: &Options,
) -> Result<String, InstrumentError> {
    let input = Input::from_text("project.st", SourceKind::Text, text).in_dialect(dialect);
    let named = |row: &super::tasks::Row| {
        let programs = table.programs.iter().skip(row.first - 1).take(row.count);
        programs.map(|entry: &Entry<'_>| entry.pou.name.text.clone()).collect()
    };
    let task = |(at, row): (usize, &super::tasks::Row)| Task {
        name: format!("task_{at}"),
        interval: row.interval,
        priority: row.priority,
        programs: named(row),
        ..Task::default()
    };
    let tasks = table.rows.iter().enumerate().map(task).collect();
    let inner = Options { target: options.target, tasks: Some(tasks), layout: options.layout, ..Options::default() };
    let attached = attach(&Plain::of(&[input])?, &inner)?;
    let texts = attached.project.files.iter().filter_map(|file| file.text.as_deref().map(marks::plain_text));
    Ok(texts.collect::<Vec<_>>().join("\n"))
}

/// A word that the project itself puts at an address.
struct PlacedWord {
    name: Span,
    /// All of its declaration.
    declaration: (u32, u32),
    word: String,
    address: String,
}

impl PlacedWord {
    fn is(&self, found: &Diagnostic) -> bool {
        found.code == Code::ShimNameTaken && found.span == self.name
    }
}

fn global_sections<'a>(unit: &'a CompilationUnit) -> impl Iterator<Item = &'a Section> {
    unit.declarations.iter().flat_map(|declaration| -> Vec<&'a Section> {
        match declaration {
            Declaration::Globals(section) => vec![section],
            Declaration::Configuration(own) => own.all_sections().collect(),
            _ => Vec::new(),
        }
    })
}

fn placed_words(trees: &[(FileId, &CompilationUnit)]) -> Vec<PlacedWord> {
    let variables = trees.iter().flat_map(|(_, unit)| global_sections(unit)).flat_map(|section| &section.variables);
    let placed = variables.filter_map(|variable| {
        let ([name], Some(address)) = (variable.names.as_slice(), &variable.address) else { return None };
        let (word, ..) = WORDS.iter().find(|(word, ..)| word.eq_ignore_ascii_case(&name.text))?;
        let end = variable.initial.as_ref().map_or(variable.spec.span.end, |initial| initial.span.end);
        Some(PlacedWord {
            name: name.span,
            declaration: (name.span.start, end),
            word: (*word).to_owned(),
            address: address.text.clone(),
        })
    });
    placed.collect()
}

/// All files of a project as one text, without configurations and without words.
struct Merged {
    text: String,
    dialect: Dialect,
    /// For each line the place that it comes from.
    places: Vec<Span>,
}

impl Merged {
    fn of(plain: &Plain, trees: &[(FileId, &CompilationUnit)], words: &[PlacedWord]) -> Result<Self, InstrumentError> {
        let dialect = plain.sources.iter().next().map_or_else(Dialect::default, |(_, file)| file.dialect());
        let mut merged = Self { text: String::new(), dialect, places: Vec::new() };
        for ((id, file), (_, unit)) in plain.sources.iter().zip(trees) {
            let mut edits = Edits::default();
            let text = file.text();
            for declaration in &unit.declarations {
                if let Declaration::Configuration(configuration) = declaration {
                    // Its sections stay, and what is around them goes.
                    let mut sections: Vec<Span> = configuration.all_sections().map(|section| section.span).collect();
                    sections.sort_by_key(|span| span.start);
                    let mut at = configuration.span.start;
                    for section in sections {
                        edits.replace(at..section.start, "\n");
                        at = section.end;
                    }
                    edits.replace(at..configuration.span.end, "\n");
                }
            }
            for word in words.iter().filter(|word| word.name.file == id) {
                let (start, end) = word.declaration;
                let semicolon = text.get(end as usize..).and_then(|rest| rest.find(';')).map_or(0, |at| at as u32 + 1);
                edits.replace(start..end + semicolon, "");
            }
            let edited = edits
                .apply(text)
                .map_err(|conflict| InstrumentError::Conflict { file: file.name().to_owned(), conflict })?;
            let mut starts: Vec<u32> = vec![0];
            starts.extend(text.match_indices('\n').map(|(at, _)| at as u32 + 1));
            for at in 0..edited.text.lines().count() {
                let line = edited.lines.original(at as u32 + 1).unwrap_or(1);
                let start = starts.get(line as usize - 1).copied().unwrap_or(0);
                merged.places.push(Span::new(id, start, start));
            }
            merged.text += &edited.text;
            if !edited.text.ends_with('\n') {
                merged.text.push('\n');
            }
        }
        Ok(merged)
    }

    fn diagnostics(&self, unsaid: Vec<Unsaid>) -> Vec<Diagnostic> {
        let found = |each: Unsaid| {
            let place = each.line.and_then(|line| self.places.get(line as usize - 1)).copied();
            let span = place.unwrap_or(Span::new(FileId(0), 0, 0));
            Diagnostic::error(Code::UnsupportedFeature, span, each.message).with_help(each.help)
        };
        unsaid.into_iter().map(found).collect()
    }

    /// What MatIEC has not of what the shim has put in.
    fn own(&self, unsaid: Vec<Unsaid>) -> Vec<Diagnostic> {
        self.diagnostics(unsaid.into_iter().map(|each| Unsaid { line: None, ..each }).collect())
    }
}

/// What is wrong with the whole project.
fn nowhere(text: &str) -> Diagnostic {
    Diagnostic::error(Code::UnsupportedFeature, Span::new(FileId(0), 0, 0), text.to_owned())
}

/// Which variable lies where.
struct Layout {
    room: Room,
    globals: Globals,
    /// Addresses of variables that are declared without, by their names in capitals.
    addresses: BTreeMap<String, String>,
    located: Vec<Located>,
}

impl Layout {
    fn new(merged: &Merged, words: &[PlacedWord], options: &Options) -> Result<Self, String> {
        let globals = matiec::globals(&merged.text, merged.dialect);
        let own = globals.addresses.iter().chain(words.iter().map(|word| &word.address)).map(String::as_str);
        let asked = options.exchanged.iter().filter_map(|each| each.address.as_deref());
        let used = own.chain(asked).filter_map(|text| Address::parse(text).or_else(|| Address::at_modbus(text)));
        let used: Vec<Address> = used.collect();
        let words_at = options.words_at.as_deref().map(|text| {
            Address::parse(text)
                .ok_or_else(|| format!("`{text}` is not an address such as %MD0, where words could begin"))
        });
        let room = Room::beside(used.into_iter(), words_at.transpose()?);
        let mut layout = Self { room, globals, addresses: BTreeMap::new(), located: Vec::new() };
        for (word, width, way) in WORDS {
            let placed = words.iter().find(|placed| placed.word == word);
            let address = match placed {
                Some(placed) => Address::parse(&placed.address).filter(|address| address.modbus().is_some()),
                None => layout.room.next(width, way),
            };
            let address = address.ok_or_else(|| format!("there is no place for `{word}` that Modbus reaches"))?;
            layout.addresses.insert(word.to_ascii_uppercase(), address.to_string());
            layout.located.push(Located {
                name: word.to_owned(),
                variable: word.to_owned(),
                carrier: word.to_owned(),
                address,
                way,
            });
        }
        Ok(layout)
    }

    /// The text in which programs take over what lies at addresses.
    fn handed_over(
        &mut self,
        merged: &Merged,
        table: &TaskTable<'_>,
        survey: &Survey<'_>,
        options: &Options,
    ) -> Result<String, String> {
        let mut handovers: Vec<Handover> =
            table.programs.iter().map(|_| Handover { externals: Vec::new(), statements: Vec::new() }).collect();
        let mut declared = String::new();
        for exchanged in &options.exchanged {
            let found = self.place(exchanged, table, survey)?;
            if let Some(declaration) = &found.declaration {
                let _ = writeln!(declared, "    {declaration};");
            }
            for (at, path) in found.programs {
                let Some(handover) = handovers.get_mut(at) else { continue };
                let variable = path.map_or_else(|| exchanged.variable.clone(), |path| format!("@{path}"));
                handover.externals.extend(found.external.clone());
                handover.statements.push((exchanged.way, found.carrier.copy(&variable, &found.name, exchanged.way)));
            }
        }
        let mut text = merged.text.clone();
        if !declared.is_empty() {
            let _ = writeln!(text, "\nVAR_GLOBAL\n{declared}END_VAR");
        }
        let file = SourceFile::new("project.st", text).in_dialect(merged.dialect);
        let unit = parse_source(FileId(0), &file).unit;
        let mut edits = Edits::default();
        let pous: Vec<&Pou> = unit.declarations.iter().filter_map(program).collect();
        for (entry, handover) in table.programs.iter().zip(&handovers) {
            let pou = pous.iter().find(|pou| pou.name.key() == entry.pou.name.key());
            if let Some(pou) = pou.filter(|pou| !handover.statements.is_empty() || !pou.chart.is_empty()) {
                taken_over::attach(pou, handover, &file, &mut edits);
            }
        }
        edits.apply(file.text()).map(|edited| edited.text).map_err(|conflict| conflict.to_string())
    }

    fn place(&mut self, exchanged: &Exchanged, table: &TaskTable<'_>, survey: &Survey<'_>) -> Result<Found, String> {
        let name = &exchanged.signal;
        let carrier = Carrier::of(exchanged.ty)
            .ok_or_else(|| format!("`{name}` is {}, which no register of Modbus holds", exchanged.ty))?;
        let root_end = exchanged.variable.find(['.', '[']).unwrap_or(exchanged.variable.len());
        let root = exchanged.variable.get(..root_end).unwrap_or("");
        let asked = wanted(exchanged, carrier)?;
        if let Some(address) = Address::parse(&exchanged.variable) {
            return self.note(exchanged, &exchanged.variable.clone(), address, Found::direct(carrier));
        }
        let program = |entry: &Entry<'_>| within(&entry.name, &exchanged.variable);
        let home = table.programs.iter().enumerate().find_map(|(at, entry)| Some((at, program(entry)?)));
        if home.is_none() && !survey.is_global(root) {
            return Err(format!("`{name}` is `{}`, which no task runs", exchanged.variable));
        }
        let is_whole_global = home.is_none() && root_end == exchanged.variable.len();
        let own = self.globals.variables.iter().find(|global| global.name.eq_ignore_ascii_case(root));
        let own = own.and_then(|global| global.address.as_deref()).and_then(Address::parse);
        if let Some(address) = own.filter(|_| is_whole_global) {
            return self.note(exchanged, root, address, Found::direct(carrier));
        }
        let none = || format!("there is no place for `{name}` that Modbus reaches");
        let address = asked.or_else(|| self.room.next(carrier.width, exchanged.way)).ok_or_else(none)?;
        if is_whole_global && carrier.is_own() {
            self.addresses.insert(root.to_ascii_uppercase(), address.to_string());
            return self.note(exchanged, root, address, Found::direct(carrier));
        }
        let at_address = self.fresh(&exchanged.variable);
        let external = format!("{at_address} : {}", carrier.type_name());
        let programs = match home {
            Some((at, path)) => vec![(at, Some(path))],
            None => (0..table.programs.len()).map(|at| (at, None)).collect(),
        };
        let declaration = Some(format!("{at_address} AT {address} : {}", carrier.type_name()));
        let found = Found { name: at_address.clone(), carrier, declaration, external: Some(external), programs };
        self.note(exchanged, &at_address, address, found)
    }

    fn note(&mut self, exchanged: &Exchanged, carrier: &str, address: Address, found: Found) -> Result<Found, String> {
        if exchanged.way == Way::ToPlc && !address.is_writable() {
            let name = &exchanged.signal;
            return Err(format!("`{name}` is written by the gateway, and {address} cannot be written over Modbus"));
        }
        if address.modbus().is_none() {
            return Err(format!("`{}` lies at {address}, which Modbus does not reach", exchanged.signal));
        }
        self.located.push(Located {
            name: exchanged.signal.clone(),
            variable: exchanged.variable.clone(),
            carrier: carrier.to_owned(),
            address,
            way: exchanged.way,
        });
        Ok(found)
    }

    /// A name for what carries a variable, which nothing else has.
    fn fresh(&mut self, path: &str) -> String {
        let mut name = String::new();
        for one in path.chars() {
            let one = if one.is_ascii_alphanumeric() { one } else { '_' };
            if one != '_' || !name.ends_with('_') {
                name.push(one);
            }
        }
        let base = name.trim_matches('_').to_owned();
        let mut name = base.clone();
        let mut number = 1;
        while !self.globals.names.insert(name.to_ascii_uppercase()) {
            number += 1;
            name = format!("{base}_{number}");
        }
        name
    }
}

fn program(declaration: &Declaration) -> Option<&Pou> {
    match declaration {
        Declaration::Pou(pou) => Some(pou),
        _ => None,
    }
}

/// The path within the instance `entry`, which may have its resource's name in front.
fn within(entry: &str, path: &str) -> Option<String> {
    let instance = entry.rsplit('.').next().unwrap_or(entry);
    [entry, instance].iter().find_map(|name| {
        let rest = path
            .get(name.len()..)
            .filter(|_| path.get(..name.len()).is_some_and(|it| it.eq_ignore_ascii_case(name)))?;
        rest.strip_prefix('.').map(str::to_owned)
    })
}

/// How an exchanged variable comes to its address.
struct Found {
    name: String,
    carrier: Carrier,
    declaration: Option<String>,
    external: Option<String>,
    /// The programs that take it over, with the path within each; nothing for a global one.
    programs: Vec<(usize, Option<String>)>,
}

impl Found {
    /// The variable itself lies at the address.
    fn direct(carrier: Carrier) -> Self {
        Self { name: String::new(), carrier, declaration: None, external: None, programs: Vec::new() }
    }
}
