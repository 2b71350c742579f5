//! Who may do what on the page: every message from everybody, as one table.

use std::fmt::Write as _;
use std::fs;

use onescan_scenario::Scenario;
use onescan_server::mailbox::Mailbox;
use onescan_server::published::Published;
use onescan_server::time::VirtualTime;
use tempfile::TempDir;

use super::*;
use crate::web::entry::Entry;
use crate::web::lesson::LessonBoard;
use crate::web::training::{Role, Training, TurnQueue};
use crate::web::{Session, Source};

const SCENE: &str = include_str!("../../../../../scenarios/templates/cell/plant.toml");
const PROGRAM: &str = include_str!("../../../../../scenarios/templates/cell/plc/main.st");
const SCENARIO: &str = include_str!("../../../../../scenarios/templates/cell/scenario.toml");
const PANELS: &str = r#"
[clients.desk]
kind = "operator"

[[panel]]
name = "operator"
element = [
    { kind = "button", signal = "Start", part = "pusher", at = [0, 0] },
    { kind = "button", label = "Reset", action = "reset", at = [1, 0] },
]

[[panel]]
name = "trainer"
seat = "trainer"
element = [
    { kind = "switch", label = "leaks", failure = "cylinder.leaking", at = [0, 0] },
    { kind = "switch", label = "sticks", disturbance = { signal = "Box_There", kind = "stuck" }, at = [1, 0] },
]

[report]
[[report.alarm]]
name = "started"
when = "Start"

[[view]]
name = "front"
position_m = [0, -4, 1]
target_m = [0, 0, 0]
"#;

/// A cell with a panel of each sort, a view, and something that fails; a variable of its PLC is numbered 0.
fn scenario() -> (TempDir, Scenario) {
    let folder = tempfile::tempdir().expect("a folder");
    let start = "[signals]\nStart = { type = \"BOOL\", writer = \"desk\" }\n";
    let text = SCENARIO.replacen("[signals]\n", start, 1) + PANELS;
    fs::create_dir(folder.path().join("plc")).expect("writable");
    for (name, text) in [("scenario.toml", &*text), ("plant.toml", SCENE), ("plc/main.st", PROGRAM)] {
        fs::write(folder.path().join(name), text).expect("writable");
    }
    let scenario = Scenario::load(folder.path()).expect("a scenario");
    (folder, scenario)
}

/// What a page is of.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Of {
    Session,
    Lesson(Role),
    Recording,
}

/// Somebody with a page.
struct Who {
    name: &'static str,
    rank: Rank,
    of: Of,
    seat: Option<&'static str>,
}

const fn who(name: &'static str, rank: Rank, of: Of, seat: Option<&'static str>) -> Who {
    Who { name, rank, of, seat }
}

const EVERYBODY: [Who; 11] = [
    who("looker", Rank::Looks, Of::Session, None),
    who("operator", Rank::Operates, Of::Session, None),
    who("seat", Rank::Operates, Of::Session, Some("operator")),
    who("chief", Rank::Trains, Of::Session, Some("trainer")),
    who("trainee", Rank::Operates, Of::Lesson(Role::Trainee), Some("operator")),
    who("guest", Rank::Trains, Of::Lesson(Role::Trainee), None),
    who("trainer", Rank::Trains, Of::Lesson(Role::Trainer), None),
    who("aide", Rank::Operates, Of::Lesson(Role::Trainer), None),
    who("witness", Rank::Looks, Of::Lesson(Role::Trainer), None),
    who("past", Rank::Trains, Of::Recording, Some("operator")),
    who("archive", Rank::Looks, Of::Recording, None),
];

/// Every message, some of them more than once where it depends on what is in it who may send it. `START` stands for
/// the number of the operator's signal, `PUSH` for that of a PLC's.
const EVERY: [&str; 35] = [
    r#"{"type":"subscribe","signals":[START]}"#,
    r#"{"type":"watch","variables":[0]}"#,
    r#"{"type":"draw","drawing":null,"instance":0}"#,
    r#"{"type":"maps","maps":[]}"#,
    r#"{"type":"show","t_ns":0}"#,
    r#"{"type":"live"}"#,
    r#"{"type":"fork","t_ns":0}"#,
    r#"{"type":"seat","panel":"operator","take":true}"#,
    r#"{"type":"seat","panel":"trainer","take":true}"#,
    r#"{"type":"seat","panel":"nobody","take":true}"#,
    r#"{"type":"write","signal":START,"value":1}"#,
    r#"{"type":"write","signal":PUSH,"value":1}"#,
    r#"{"type":"write","signal":99,"value":1}"#,
    r#"{"type":"reset","panel":"operator"}"#,
    r#"{"type":"reset","panel":"trainer"}"#,
    r#"{"type":"operate","operation":"hold"}"#,
    r#"{"type":"operate","operation":"go"}"#,
    r#"{"type":"operate","operation":"step"}"#,
    r#"{"type":"operate","operation":"stop"}"#,
    r#"{"type":"fail","component":"cylinder","failure":"leaking","active":true}"#,
    r#"{"type":"disturb","disturbance":0,"active":true}"#,
    r#"{"type":"variable","variable":0,"action":"force","value":"TRUE"}"#,
    r#"{"type":"force","signal":PUSH,"value":"1"}"#,
    r#"{"type":"train","turn":"repeat"}"#,
    r#"{"type":"train","turn":"back","t_ns":0}"#,
    r#"{"type":"train","turn":"jump","start":"melting"}"#,
    r#"{"type":"acknowledge","alarms":[0]}"#,
    r#"{"type":"acknowledge","alarms":[9]}"#,
    r#"{"type":"shelve","alarm":0,"for_s":60}"#,
    r#"{"type":"shelve","alarm":0,"for_s":0}"#,
    r#"{"type":"view","view":"front"}"#,
    r#"{"type":"view","view":"nowhere"}"#,
    r#"{"type":"parameter","component":"cylinder","parameter":"stroke_m","value":"0.3"}"#,
    r#"{"type":"case","name":"mine","save":false}"#,
    r#"{"type":"trace","signals":[START],"from_ns":0,"until_ns":0,"parts":1}"#,
];

/// The place of each kind of message; one that is added does not compile before it has one.
const KINDS: usize = 22;
fn kind(ask: &Ask) -> usize {
    match ask {
        Ask::Subscribe { .. } => 0,
        Ask::Write { .. } => 1,
        Ask::Operate { .. } => 2,
        Ask::Seat { .. } => 3,
        Ask::Fail { .. } => 4,
        Ask::Disturb { .. } => 5,
        Ask::Train(_) => 6,
        Ask::Show { .. } => 7,
        Ask::View { .. } => 8,
        Ask::Draw { .. } => 9,
        Ask::Watch { .. } => 10,
        Ask::Maps { .. } => 11,
        Ask::Variable { .. } => 12,
        Ask::Force { .. } => 13,
        Ask::Live => 14,
        Ask::Fork { .. } => 15,
        Ask::Acknowledge { .. } => 16,
        Ask::Shelve { .. } => 17,
        Ask::Reset { .. } => 18,
        Ask::Parameter { .. } => 19,
        Ask::Case { .. } => 20,
        Ask::Trace { .. } => 21,
    }
}

fn session(scenario: &Scenario, of: Of) -> Session {
    let mailbox = Mailbox::new();
    let layout = onescan_server::layout::ImageLayout::new(scenario.plan().signals());
    let published = Published::new(layout.size());
    let training = match of {
        Of::Lesson(role) => Some(Training {
            role,
            turns: TurnQueue::new(mailbox.clone()),
            lesson: "lesson".to_owned(),
            about: None,
            view: None,
            starts: vec!["melting".to_owned()],
            asked: Vec::new(),
            mistakes: Vec::new(),
            board: LessonBoard::default(),
        }),
        Of::Session | Of::Recording => None,
    };
    let recorded_to = (of == Of::Recording).then_some(VirtualTime::ZERO);
    let source = Source { training, recorded_to, ..Source::new(scenario, published, mailbox, "max".to_owned()) };
    Session::new(source, Entry::new(None, 0, false), "http", None).expect("a session")
}

/// What comes of a message: `yes`, or why not, as the error is called.
fn outcome(text: &str, session: &Session, who: &Who) -> String {
    let viewer = session.seats.enter();
    if let Some(panel) = who.seat {
        session.seats.claim(panel, viewer, true).expect("a free seat");
    }
    let (outcomes, _done) = mpsc::unbounded_channel();
    let mut subscription = Subscription::new(session);
    let outcome = match handle(text, session, (viewer, who.rank), &mut subscription, &outcomes) {
        Ok(_) => "yes".to_owned(),
        Err(refused) => {
            let shown = format!("{refused:?}");
            shown.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned()
        }
    };
    session.seats.leave(viewer);
    outcome
}

/// A click on a part of the machine is a press of the key that lies on it: the page learns where that is, and what it sends
/// is the key's message, which is for whoever operates the panel.
#[test]
fn a_key_on_the_machine_is_a_key_of_its_panel() {
    let (folder, scenario) = scenario();
    let (structure, _) = crate::web::structure::of(&scenario, None).expect("a structure");
    let structure = serde_json::to_value(&structure).expect("JSON");
    let key = &structure["panels"][0]["elements"][0];
    let body = key["bodies"][0].as_u64().and_then(|number| usize::try_from(number).ok()).expect("a body");
    assert_eq!(structure["bodies"][body]["name"], "pusher");
    assert!(key.get("components").is_none(), "{key}");
    let start = structure["signals"].as_array().and_then(|all| all.iter().position(|one| one["name"] == key["signal"]));
    let write = format!(r#"{{"type":"write","signal":{},"value":1}}"#, start.expect("declared"));
    let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime");
    let outcomes = runtime.block_on(async {
        let session = session(&scenario, Of::Session);
        [&EVERYBODY[0], &EVERYBODY[1], &EVERYBODY[2]].map(|who| outcome(&write, &session, who))
    });
    assert_eq!(outcomes, ["LooksOnly", "NoSeat", "yes"]);
    // What is not there is an error at its place.
    let path = folder.path().join("scenario.toml");
    let text = fs::read_to_string(&path).expect("a file").replace("part = \"pusher\"", "part = \"pushre\"");
    fs::write(&path, text).expect("writable");
    let scenario = Scenario::load(folder.path()).expect("a scenario");
    let Err(error) = crate::web::structure::of(&scenario, None) else { panic!("there is no such part") };
    let error = error.to_string();
    assert!(error.contains("the element lies on a part `pushre`, which is not there"), "{error}");
}

#[test]
fn everybody_may_do_what_is_theirs() {
    let (_folder, scenario) = scenario();
    let number = |name: &str| scenario.plan().signals().iter().position(|signal| signal.name.as_str() == name);
    let [start, push] = ["Start", "Push"].map(|name| number(name).expect("declared").to_string());
    let every = EVERY.map(|text| text.replace("START", &start).replace("PUSH", &push));
    let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime");
    let columns = runtime.block_on(async {
        let column = |who: &Who| {
            let session = session(&scenario, who.of);
            every.each_ref().map(|text| outcome(text, &session, who))
        };
        EVERYBODY.each_ref().map(column)
    });
    let mut table = format!("{:42}", "message");
    for who in &EVERYBODY {
        write!(table, " {:10}", who.name).expect("a string takes all");
    }
    let mut seen = [false; KINDS];
    for (row, text) in EVERY.iter().enumerate() {
        seen[kind(&Ask::read(&every[row]).expect("a message"))] = true;
        let bare: String = text.trim_start_matches(r#"{"type":"#).chars().filter(|c| !"\"{}".contains(*c)).collect();
        write!(table, "\n{:42}", bare.chars().take(42).collect::<String>()).expect("a string takes all");
        for column in &columns {
            write!(table, " {:10}", column[row]).expect("a string takes all");
        }
    }
    assert_eq!(seen, [true; KINDS], "every kind of message");
    let table: String = table.lines().map(|line| format!("{}\n", line.trim_end())).collect();
    insta::assert_snapshot!(table, @r"
    message                                    looker     operator   seat       chief      trainee    guest      trainer    aide       witness    past       archive
    subscribe,signals:[START]                  yes        yes        yes        yes        yes        yes        yes        yes        yes        yes        yes
    watch,variables:[0]                        yes        yes        yes        yes        yes        yes        yes        yes        yes        yes        yes
    draw,drawing:null,instance:0               yes        yes        yes        yes        yes        yes        yes        yes        yes        yes        yes
    maps,maps:[]                               yes        yes        yes        yes        yes        yes        yes        yes        yes        yes        yes
    show,t_ns:0                                Past       Past       Past       Past       Past       Past       Past       Past       Past       Past       Past
    live                                       yes        yes        yes        yes        yes        yes        yes        yes        yes        yes        yes
    fork,t_ns:0                                LooksOnly  Past       Past       Past       Trainee    Trainee    Past       Past       LooksOnly  Past       LooksOnly
    seat,panel:operator,take:true              LooksOnly  yes        yes        yes        yes        yes        yes        yes        LooksOnly  Recorded   LooksOnly
    seat,panel:trainer,take:true               LooksOnly  Trainers   Trainers   yes        NoPanel    NoPanel    yes        Trainers   LooksOnly  Recorded   LooksOnly
    seat,panel:nobody,take:true                LooksOnly  NoPanel    NoPanel    NoPanel    NoPanel    NoPanel    NoPanel    NoPanel    LooksOnly  Recorded   LooksOnly
    write,signal:START,value:1                 LooksOnly  NoSeat     yes        NoSeat     yes        NoSeat     NoSeat     NoSeat     LooksOnly  Recorded   LooksOnly
    write,signal:PUSH,value:1                  LooksOnly  NoSeat     NoSeat     NoSeat     NoSeat     NoSeat     NoSeat     NoSeat     LooksOnly  Recorded   LooksOnly
    write,signal:99,value:1                    LooksOnly  NoSignal   NoSignal   NoSignal   NoSignal   NoSignal   NoSignal   NoSignal   LooksOnly  Recorded   LooksOnly
    reset,panel:operator                       LooksOnly  NotSeated  yes        NotSeated  InLesson   InLesson   InLesson   InLesson   LooksOnly  Recorded   LooksOnly
    reset,panel:trainer                        LooksOnly  NoReset    NoReset    NoReset    NoReset    NoReset    NoReset    NoReset    LooksOnly  Recorded   LooksOnly
    operate,operation:hold                     LooksOnly  yes        yes        yes        Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    operate,operation:go                       LooksOnly  yes        yes        yes        Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    operate,operation:step                     LooksOnly  yes        yes        yes        Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    operate,operation:stop                     LooksOnly  yes        yes        yes        Trainee    Trainee    yes        yes        LooksOnly  yes        LooksOnly
    fail,component:cylinder,failure:leaking,ac LooksOnly  yes        yes        yes        Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    disturb,disturbance:0,active:true          LooksOnly  yes        yes        yes        Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    variable,variable:0,action:force,value:TRU LooksOnly  yes        yes        yes        Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    force,signal:PUSH,value:1                  LooksOnly  yes        yes        yes        Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    train,turn:repeat                          LooksOnly  NoLesson   NoLesson   NoLesson   Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    train,turn:back,t_ns:0                     LooksOnly  NoLesson   NoLesson   NoLesson   Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    train,turn:jump,start:melting              LooksOnly  NoLesson   NoLesson   NoLesson   Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    acknowledge,alarms:[0]                     LooksOnly  yes        yes        yes        yes        yes        yes        yes        LooksOnly  Recorded   LooksOnly
    acknowledge,alarms:[9]                     LooksOnly  NoAlarm    NoAlarm    NoAlarm    NoAlarm    NoAlarm    NoAlarm    NoAlarm    LooksOnly  Recorded   LooksOnly
    shelve,alarm:0,for_s:60                    LooksOnly  yes        yes        yes        yes        yes        yes        yes        LooksOnly  Recorded   LooksOnly
    shelve,alarm:0,for_s:0                     LooksOnly  NoShelf    NoShelf    NoShelf    NoShelf    NoShelf    NoShelf    NoShelf    LooksOnly  Recorded   LooksOnly
    view,view:front                            LooksOnly  NoTrainer  NoTrainer  yes        Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    view,view:nowhere                          LooksOnly  NoView     NoView     NoView     NoView     NoView     NoView     NoView     LooksOnly  Recorded   LooksOnly
    parameter,component:cylinder,parameter:str LooksOnly  yes        yes        yes        Trainee    Trainee    yes        yes        LooksOnly  Recorded   LooksOnly
    case,name:mine,save:false                  LooksOnly  NoCase     NoCase     NoCase     Trainee    Trainee    NoCase     NoCase     LooksOnly  NoCase     LooksOnly
    trace,signals:[START],from_ns:0,until_ns:0 Past       Past       Past       Past       Past       Past       Past       Past       Past       Past       Past
    ");
}
