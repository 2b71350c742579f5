//! Laws of all changes, and what single ones write.

use proptest::prelude::*;

use super::*;
use crate::edit::change::{Given, Sort};

const SCENARIO: &str = include_str!("../../../../../scenarios/templates/cell/scenario.toml");
const SCENE: &str = include_str!("../../../../../scenarios/templates/cell/plant.toml");

fn workspace() -> Workspace {
    texts(SCENARIO, SCENE)
}

fn texts(scenario: &str, scene: &str) -> Workspace {
    let scenes = [("plant.toml".to_owned(), scene.to_owned())].into();
    Workspace::new(Texts { scenario: scenario.to_owned(), scenes }, 0)
}

/// The lines that a change took away and those that it brought, in one file.
fn diff(before: &str, after: &str) -> String {
    let diff = similar::TextDiff::from_lines(before, after);
    let changes = diff.iter_all_changes().filter(|change| change.tag() != similar::ChangeTag::Equal);
    changes.map(|change| format!("{}{change}", change.tag())).collect()
}

fn in_scenario(edit: &Edit) -> String {
    let mut workspace = workspace();
    match workspace.change(std::slice::from_ref(edit)) {
        Ok(()) => diff(SCENARIO, &workspace.texts().scenario),
        Err(error) => format!("refused: {error}"),
    }
}

fn in_scene(edit: &Edit) -> String {
    let mut workspace = workspace();
    match workspace.change(std::slice::from_ref(edit)) {
        Ok(()) => diff(SCENE, &workspace.texts().scenes["plant.toml"]),
        Err(error) => format!("refused: {error}"),
    }
}

fn connect(signal: &str, variable: &str) -> Edit {
    Edit::Connect { client: "plc".into(), signal: signal.into(), variable: variable.into() }
}

fn set(sort: Sort, name: &str, key: &str, value: Option<Given>) -> Edit {
    Edit::Set { scene: "plant.toml".into(), sort, name: name.into(), key: key.into(), value }
}

fn rename(sort: Sort, name: &str, to: &str) -> Edit {
    Edit::Rename { scene: "plant.toml".into(), sort, name: name.into(), to: to.into() }
}

fn remove(sort: Sort, name: &str) -> Edit {
    Edit::Remove { scene: "plant.toml".into(), sort, name: name.into() }
}

#[test]
fn a_connection_is_the_one_line_that_a_person_would_have_written() {
    assert_eq!(in_scenario(&connect("Box_There", "Main.Box_Seen")), "+bind = { Box_There = \"Main.Box_Seen\" }\n");
    let mut workspace = workspace();
    workspace.change(&[connect("Box_There", "Main.Box_Seen")]).expect("a client");
    let one = workspace.texts().scenario.clone();
    workspace.change(&[connect("Push", "Main.Valve")]).expect("a client");
    let both = "bind = { Box_There = \"Main.Box_Seen\", Push = \"Main.Valve\" }\n";
    assert_eq!(
        diff(&one, &workspace.texts().scenario),
        format!("-bind = {{ Box_There = \"Main.Box_Seen\" }}\n+{both}")
    );
    workspace.change(&[Edit::Disconnect { client: "plc".into(), signal: "Push".into() }]).expect("bound");
    assert_eq!(workspace.texts().scenario, one);
    workspace.change(&[Edit::Disconnect { client: "plc".into(), signal: "Box_There".into() }]).expect("bound");
    assert_eq!(workspace.texts().scenario, SCENARIO, "nothing of it is left");
}

#[test]
fn a_table_of_bindings_gets_a_line_and_a_dotted_one_too() {
    let with = |bind: &str| format!("{SCENARIO}\n[clients.pump]\nkind = \"soft-plc\"\n{bind}");
    let to = |signal: &str| Edit::Connect { client: "pump".into(), signal: signal.into(), variable: "P.x".into() };
    for (bind, line) in [
        ("[clients.pump.bind]\nA = \"P.a\" # first\n", "+\"B[1]\" = \"P.x\"\n"),
        ("bind.A = \"P.a\"\nsources = []\n", "+bind.\"B[1]\" = \"P.x\"\n"),
    ] {
        let before = with(bind);
        let mut workspace = texts(&before, SCENE);
        workspace.change(&[to("B[1]")]).expect("a client");
        assert_eq!(diff(&before, &workspace.texts().scenario), line);
        workspace.change(&[to("A")]).expect("a client");
        assert!(workspace.texts().scenario.contains("A = \"P.x\""), "{}", workspace.texts().scenario);
    }
}

#[test]
fn a_signal_is_declared_behind_the_others() {
    let declare = |signal: &str, writer: &str| Edit::Declare {
        signal: signal.into(),
        ty: "BOOL".into(),
        writer: writer.into(),
        unit: None,
        about: Some("a \"lamp\"".into()),
    };
    assert_eq!(
        in_scenario(&declare("Lamp", "plc")),
        "+Lamp = { type = \"BOOL\", writer = \"plc\", about = 'a \"lamp\"' }\n"
    );
    assert_eq!(in_scenario(&declare("Push", "plc")), "refused: there is a signal `Push` already");
    assert_eq!(
        in_scenario(&declare("Lamp", "plcs")),
        "refused: there is no client `plcs` in scenario.toml (did you mean `plc`?)"
    );
    let bare = "version = 1\n\n# The clients.\n[clients.plc]\nkind = \"soft-plc\"\n";
    let mut workspace = texts(bare, SCENE);
    workspace.change(&[declare("Lamp", "plc")]).expect("a client");
    let line = "Lamp = { type = \"BOOL\", writer = \"plc\", about = 'a \"lamp\"' }";
    assert_eq!(
        workspace.texts().scenario,
        format!("version = 1\n\n[signals]\n{line}\n\n# The clients.\n[clients.plc]\nkind = \"soft-plc\"\n")
    );
    workspace.change(&[Edit::Withdraw { signal: "Lamp".into() }]).expect("nobody uses it");
    assert!(!workspace.texts().scenario.contains("Lamp"));
}

#[test]
fn a_signal_that_somebody_uses_stays() {
    assert_eq!(
        in_scenario(&Edit::Withdraw { signal: "Pushed".into() }),
        "-Pushed = { type = \"DINT\", writer = \"plc\", about = \"boxes pushed off the belt\" }\n"
    );
    assert_eq!(
        in_scenario(&Edit::Withdraw { signal: "Push".into() }),
        "refused: signal `Push` is needed by component `cylinder`, extend_signal; [expect]; [plot.signals]"
    );
}

#[test]
fn values_change_where_they_stand() {
    assert_eq!(
        in_scene(&set(Sort::Component, "conveyor", "speed_m_s", Some(Given::Number(0.4)))),
        "-speed_m_s = 0.3\n+speed_m_s = 0.4\n"
    );
    let body = Edit::Move { scene: "plant.toml".into(), body: "pusher".into(), position_m: [0.35, -0.2, 0.06] };
    assert_eq!(in_scene(&body), "-position_m = [0.35, -0.17, 0.06]\n+position_m = [0.35, -0.2, 0.06]\n");
    assert_eq!(
        in_scene(&set(Sort::Joint, "slide", "axis", Some(Given::Numbers(vec![1.0, 0.0, 0.5])))),
        "-axis = [0, 1, 0]\n+axis = [1, 0, 0.5]\n"
    );
    assert_eq!(in_scene(&set(Sort::Body, "box[0..3]", "friction", None)), "-friction = 0.4\n");
    assert_eq!(in_scene(&set(Sort::Body, "belt", "restitution", Some(Given::Number(1.0)))), "+restitution = 1.0\n");
}

#[test]
fn what_a_table_cannot_say_is_refused() {
    let all = [
        set(Sort::Component, "conveyor", "speed_m_s", Some(Given::Number(1000.0))),
        set(Sort::Component, "conveyor", "speed", Some(Given::Number(1.0))),
        set(Sort::Component, "conveyor", "belt", None),
        set(Sort::Component, "conveyer", "belt", None),
        set(Sort::Body, "belt", "name", Some(Given::Text("band".into()))),
        remove(Sort::Body, "belt"),
        remove(Sort::Joint, "slide"),
        rename(Sort::Body, "belt", "pusher"),
        rename(Sort::Body, "box[0..3]", "parcel"),
        rename(Sort::Body, "belt", " "),
        Edit::Disconnect { client: "plc".into(), signal: "Push".into() },
    ];
    let said: Vec<_> = all.iter().map(in_scene).collect();
    assert_eq!(
        said,
        [
            "refused: `speed_m_s` is a number from 0.000001 to 100, which 1000 is not",
            "refused: component `conveyor` has no `speed`",
            "refused: `belt` of component `conveyor` can be changed, but not taken away",
            "refused: there is no component `conveyer` in plant.toml (did you mean `conveyor`?)",
            "refused: `name` of body `belt` is not set: rename it, or place another in its stead",
            "refused: body `belt` is needed by component `conveyor`, belt",
            "refused: joint `slide` is needed by component `cylinder`, joint",
            "refused: there is a body `pusher` already",
            "refused: `box[0..3]` stands for several: its new name ends with `[0..3]`, too",
            "refused: ` ` cannot be a name: one without spaces at its ends, line breaks and quotes is needed",
            "refused: `Push` is the variable of its name in `plc`: nothing in `bind` says so, and nothing there can take it back",
        ]
    );
}

#[test]
fn a_new_name_goes_to_all_who_refer_to_it() {
    assert_eq!(
        in_scene(&rename(Sort::Body, "box[0..3]", "parcel[0..3]")),
        "-name = \"box[0..3]\"             # an array: box[0], box[1], box[2], box[3]\n\
         +name = \"parcel[0..3]\"             # an array: box[0], box[1], box[2], box[3]\n\
         -targets = [\"box[0..3]\"]\n+targets = [\"parcel[0..3]\"]\n\
         -targets = [\"box[0..3]\"]\n+targets = [\"parcel[0..3]\"]\n\
         -targets = [\"box[0..3]\"]\n+targets = [\"parcel[0..3]\"]\n"
    );
    let set = format!("{SCENARIO}\n[clients.plant.set]\ncylinder.stroke_m = 0.3\n");
    let scene = format!("{SCENE}\n[[failure]]\ncomponent = \"cylinder\"\nmode = \"leaking\"\n");
    let mut workspace = texts(&set, &scene);
    workspace.change(&[rename(Sort::Component, "cylinder", "ram")]).expect("there");
    assert_eq!(diff(&set, &workspace.texts().scenario), "-cylinder.stroke_m = 0.3\n+ram.stroke_m = 0.3\n");
    let after = diff(&scene, &workspace.texts().scenes["plant.toml"]);
    assert_eq!(after, "-name = \"cylinder\"\n+name = \"ram\"\n-component = \"cylinder\"\n+component = \"ram\"\n");
}

#[test]
fn a_thing_comes_behind_the_last_one_of_its_sort() {
    let keys = [("kind", "fixed"), ("shape", "box")].map(|(key, value)| (key.to_owned(), Given::Text(value.into())));
    let size = ("size_m".to_owned(), Given::Numbers(vec![1.0, 0.5, 0.25]));
    let keys: Vec<_> = keys.into_iter().chain([size]).collect();
    let add = Edit::Add { scene: "plant.toml".into(), sort: Sort::Body, name: "table".into(), keys };
    let table = "[[body]]\nname = \"table\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [1.0, 0.5, 0.25]\n";
    let mut workspace = texts(SCENARIO, "version = 1");
    workspace.change(std::slice::from_ref(&add)).expect("a body");
    assert_eq!(workspace.texts().scenes["plant.toml"], format!("version = 1\n\n{}", table.trim_end()));
    let mut workspace = self::workspace();
    workspace.change(std::slice::from_ref(&add)).expect("a body");
    let text = &workspace.texts().scenes["plant.toml"];
    assert_eq!(*text, SCENE.replace("\n# ---- components", &format!("\n{table}\n# ---- components")));
    workspace.change(&[remove(Sort::Body, "table")]).expect("nobody needs it");
    assert_eq!(workspace.texts().scenes["plant.toml"], SCENE);
}

fn a_name() -> impl Strategy<Value = String> {
    prop::sample::select(vec!["belt", "box[0..3]", "pusher", "slide", "cylinder", "barrier", "sink", "new", "a b", "é"])
        .prop_map(str::to_owned)
}

fn a_sort() -> impl Strategy<Value = Sort> {
    prop::sample::select(vec![Sort::Body, Sort::Joint, Sort::Component, Sort::Shape])
}

fn a_value() -> impl Strategy<Value = Given> {
    prop_oneof![
        any::<bool>().prop_map(Given::Flag),
        (-1e3_f64..1e3).prop_map(Given::Number),
        prop::collection::vec(-9.0_f64..9.0, 3).prop_map(Given::Numbers),
        "[a-z\"'\\\\#\\[ ]{0,6}".prop_map(Given::Text),
        prop::sample::select(vec!["fixed", "dynamic", "box", "belt", "slide"])
            .prop_map(|word| Given::Text(word.to_owned())),
        Just(Given::Texts(vec!["box[0..3]".to_owned(), "pusher".to_owned()])),
    ]
}

fn a_key() -> impl Strategy<Value = String> {
    prop::sample::select(vec![
        "position_m",
        "size_m",
        "friction",
        "kind",
        "shape",
        "stroke_m",
        "targets",
        "body",
        "joint",
        "axis",
        "parent",
        "child",
        "extend_signal",
        "range_m",
        "collides",
        "mass_kg",
    ])
    .prop_map(str::to_owned)
}

fn an_edit() -> impl Strategy<Value = Edit> {
    let signal = || prop::sample::select(vec!["Push", "Box_There", "Pushed", "New", "L[1].x"]).prop_map(str::to_owned);
    let scene = || "plant.toml".to_owned();
    prop_oneof![
        (signal(), "[A-Za-z.\\[\\]0-9\"]{1,8}").prop_map(|(signal, variable)| Edit::Connect {
            client: "plc".into(),
            signal,
            variable
        }),
        signal().prop_map(|signal| Edit::Disconnect { client: "plc".into(), signal }),
        signal().prop_map(|signal| Edit::Withdraw { signal }),
        (signal(), proptest::option::of("[ -~]{0,9}")).prop_map(|(signal, about)| Edit::Declare {
            signal,
            ty: "BOOL".into(),
            writer: "plc".into(),
            unit: None,
            about
        }),
        (a_sort(), a_name(), prop::collection::vec((a_key(), a_value()), 0..5))
            .prop_map(move |(sort, name, keys)| Edit::Add { scene: scene(), sort, name, keys }),
        (a_sort(), a_name(), a_key(), proptest::option::of(a_value()))
            .prop_map(move |(sort, name, key, value)| Edit::Set { scene: scene(), sort, name, key, value }),
        (a_name(), prop::array::uniform3(-9.0_f64..9.0)).prop_map(move |(body, position_m)| Edit::Move {
            scene: scene(),
            body,
            position_m
        }),
        (a_sort(), a_name(), a_name()).prop_map(move |(sort, name, to)| Edit::Rename {
            scene: scene(),
            sort,
            name,
            to
        }),
        (a_sort(), a_name()).prop_map(move |(sort, name)| Edit::Remove { scene: scene(), sort, name }),
    ]
}

/// Comments that stand by themselves: nothing that a change takes away takes them along.
fn far_comments(text: &str) -> Vec<&str> {
    let blocks = text.split("\n\n").filter(|block| block.lines().all(|line| line.starts_with('#')));
    blocks.flat_map(str::lines).filter(|line| !line.is_empty()).collect()
}

/// All comments and lines of a text, in their order, are among those of another.
fn is_within(lines: &[&str], text: &str) -> bool {
    let mut rest = text.lines();
    lines.iter().all(|line| rest.any(|other| other == *line))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_changes_leave_files_that_parse_keep_comments_and_can_be_taken_back(
        edits in prop::collection::vec(an_edit(), 1..25),
    ) {
        let mut workspace = workspace();
        let mut made = vec![workspace.texts().clone()];
        let (top, far) = (far_comments(SCENARIO), far_comments(SCENE));
        for edit in &edits {
            let before = workspace.texts().clone();
            if workspace.change(std::slice::from_ref(edit)).is_err() {
                prop_assert_eq!(&before, workspace.texts(), "what is refused changes nothing");
                continue;
            }
            let scene = &workspace.texts().scenes["plant.toml"];
            for text in [&workspace.texts().scenario, scene] {
                prop_assert!(text.parse::<toml_edit::DocumentMut>().is_ok(), "{edit:?}\n{text}");
            }
            prop_assert!(is_within(&top, &workspace.texts().scenario) && is_within(&far, scene), "{edit:?}\n{scene}");
            if *workspace.texts() != before {
                made.push(workspace.texts().clone());
            }
        }
        let last = workspace.texts().clone();
        for texts in made.iter().rev().skip(1) {
            prop_assert!(workspace.undo());
            prop_assert_eq!(texts, workspace.texts());
        }
        prop_assert!(!workspace.undo());
        while workspace.redo() {}
        prop_assert_eq!(&last, workspace.texts());
    }
}
