//! Files that files name: a scenario reads its own folder, whichever of its files names one outside, and however.
#![cfg(unix)]

use std::fs::write;
use std::path::{Path, PathBuf};

use crate::typed::flat;
use crate::typed::{Said, typed};

const SECRET: &str = "s3cret";
const STL: &str = "solid part\nfacet normal 0 0 0\nouter loop\nvertex s3cret 0 0\n";
const BODY: &str = "version = 1\n[[body]]\nname = \"part\"\nkind = \"fixed\"\nshape = \"mesh\"\nmesh = \"MESH\"\n";
const ROBOT: &str = "version = 1\n[[urdf]]\nname = \"arm\"\nfile = \"FILE\"\n";
const SCENARIO: &str = "version = 1\nstep = \"10ms\"\nuntil = \"10ms\"\n[signals]\n[clients.plant]\nkind = \"plant\"\nscene = \"plant.toml\"\n";

/// A scenario in a folder, and a folder beside it that is not its own.
struct Place {
    _folder: tempfile::TempDir,
    own: PathBuf,
    other: PathBuf,
}

fn place(scene: &str) -> Place {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    let (own, other) = (root.join("own"), root.join("other"));
    std::fs::create_dir_all(&own).unwrap();
    std::fs::create_dir_all(other.join("cell/meshes")).unwrap();
    write(own.join("scenario.toml"), SCENARIO).unwrap();
    write(own.join("plant.toml"), scene).unwrap();
    Place { _folder: folder, own, other }
}

fn said_all(said: &Said) -> String {
    flat(&(said.out.clone() + &said.err))
}

/// It is refused by all who read scenes, and nothing of what is in the file is said; with permission it is read.
fn is_refused(at: &Place) {
    for words in [["run", "."], ["describe", "."], ["describe", "plant.toml"], ["wiring", "."]] {
        let said = typed(&at.own, &words);
        let all = said_all(&said);
        assert!(said.code == Some(2) && all.contains("outside of the scenario's folder"), "{words:?}: {said:?}");
        assert!(!all.contains(SECRET), "{words:?}: {said:?}");
    }
    let allowed = typed(&at.own, &["describe", "plant.toml", "--allow-path", at.other.to_str().unwrap()]);
    assert!(!said_all(&allowed).contains("outside of the scenario's folder"), "{allowed:?}");
}

fn robot(at: &Place, name: &str, text: &str) {
    write(at.own.join(name), text).unwrap();
}

#[test]
fn meshes() {
    let at = place(&BODY.replace("MESH", "../other/part.stl"));
    write(at.other.join("part.stl"), STL).unwrap();
    is_refused(&at);
}

#[test]
fn meshes_behind_a_link() {
    let at = place(&BODY.replace("MESH", "part.stl"));
    write(at.other.join("part.stl"), STL).unwrap();
    std::os::unix::fs::symlink(at.other.join("part.stl"), at.own.join("part.stl")).unwrap();
    is_refused(&at);
}

#[test]
fn robots() {
    let at = place(&ROBOT.replace("FILE", "../other/arm.urdf"));
    write(at.other.join("arm.urdf"), "<robot name=\"arm\"><s3cret/></robot><").unwrap();
    is_refused(&at);
}

#[test]
fn meshes_of_robots_beside_them_and_in_packages() {
    let link = |mesh: &str| {
        format!(
            "<robot name=\"a\"><link name=\"b\"><collision><geometry><mesh filename=\"{mesh}\"/></geometry></collision></link></robot>"
        )
    };
    for (scene, mesh) in [
        (ROBOT.to_owned(), "../other/cell/meshes/part.stl"),
        (ROBOT.to_owned() + "packages = { cell = \"../other/cell\" }\n", "package://cell/meshes/part.stl"),
    ] {
        let at = place(&scene.replace("FILE", "arm.urdf"));
        write(at.other.join("cell/meshes/part.stl"), STL).unwrap();
        robot(&at, "arm.urdf", &link(mesh));
        is_refused(&at);
    }
}

#[test]
fn includes_and_tables_of_xacros() {
    let xacro = |inner: &str| {
        format!("<robot name=\"a\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">{inner}<link name=\"b\"/></robot>")
    };
    for inner in [
        "<xacro:include filename=\"../other/part.xacro\"/>",
        "<xacro:property name=\"t\" value=\"${load_yaml('../other/part.yaml')}\"/><xacro:property name=\"u\" value=\"${t['x']}\"/><a b=\"${u}\"/>",
    ] {
        let at = place(&ROBOT.replace("FILE", "arm.xacro"));
        write(at.other.join("part.xacro"), "<robot><s3cret></robot>").unwrap();
        write(at.other.join("part.yaml"), "x: [s3cret\n").unwrap();
        robot(&at, "arm.xacro", &xacro(inner));
        is_refused(&at);
    }
}

/// The buffer of a glTF file; it has no text that could be shown.
#[test]
fn buffers_of_meshes() {
    let at = place(&BODY.replace("MESH", "part.gltf"));
    write(at.other.join("part.bin"), [0; 48]).unwrap();
    let text = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":48,"uri":"../other/part.bin"}],
        "bufferViews":[{"buffer":0,"byteLength":48}],"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}]}"#;
    write(at.own.join("part.gltf"), text).unwrap();
    let describe = |words: &[&str]| said_all(&typed(&at.own, &[&["describe", "plant.toml"], words].concat()));
    assert!(describe(&[]).contains("outside of the scenario's folder"));
    assert!(!describe(&["--allow-path", at.other.to_str().unwrap()]).contains("outside of"));
}

/// Scenes themselves, for those who only describe them.
#[test]
fn scenes() {
    let at = place("");
    write(at.other.join("plant.toml"), "version = s3cret\n").unwrap();
    write(at.own.join("scenario.toml"), SCENARIO.replace("plant.toml", "../other/plant.toml")).unwrap();
    for command in ["run", "describe", "wiring"] {
        let said = typed(&at.own, &[command, "."]);
        let all = said_all(&said);
        assert!(said.code == Some(2) && all.contains("outside of the scenario's folder"), "{command}: {said:?}");
        assert!(!all.contains(SECRET), "{command}: {said:?}");
    }
}

/// Keys and certificates of a link.
#[test]
fn keys_of_links() {
    let link = |key: &Path| {
        format!(
            "[clients.plc]\nkind = \"gateway\"\n[clients.plc.gateway]\nurl = \"opc.tcp://127.0.0.1:1\"\n[clients.plc.gateway.opcua]\n\
             user_certificate = \"a.pem\"\nuser_key = '{}'\n",
            key.display()
        )
    };
    let at = place("version = 1\n");
    let key = at.other.join("key.pem");
    write(&key, SECRET).unwrap();
    write(at.own.join("scenario.toml"), SCENARIO.to_owned() + &link(&key)).unwrap();
    let said = typed(&at.own, &["run", "."]);
    let all = said_all(&said);
    assert!(said.code == Some(2) && all.contains("outside of the scenario's folder"), "{said:?}");
}

/// It is refused, and nothing of what is in the file is said; with permission it is read.
fn is_refused_by(at: &Place, words: &[&str]) {
    let said = typed(&at.own, words);
    let all = said_all(&said);
    assert!(said.code == Some(2) && all.contains("outside of the") && all.contains("more"), "{words:?}: {said:?}");
    assert!(!all.contains(SECRET), "{words:?}: {said:?}");
    let allowed = typed(&at.own, &[words, &["--allow-path", at.other.to_str().unwrap()]].concat());
    assert!(said_all(&allowed).contains(SECRET), "{words:?}: {allowed:?}");
}

/// PLC sources of a folder that is no scenario.
#[test]
fn sources_of_folders() {
    let at = place("");
    std::fs::remove_file(at.own.join("scenario.toml")).unwrap();
    write(at.other.join("a.st"), SECRET).unwrap();
    write(at.own.join("b.st"), "PROGRAM P END_PROGRAM").unwrap();
    std::os::unix::fs::symlink(at.other.join("a.st"), at.own.join("a.st")).unwrap();
    is_refused_by(&at, &["check", "."]);
    is_refused_by(&at, &["instrument", ".", "-o", "out"]);
    // One that the user names is read wherever it is.
    assert!(said_all(&typed(&at.own, &["check", "a.st"])).contains(SECRET));
}

/// Those that a project of TwinCAT lists.
#[test]
fn sources_of_projects() {
    let at = place("");
    std::fs::remove_file(at.own.join("scenario.toml")).unwrap();
    let secret = at.other.join("a.TcPOU");
    write(
        &secret,
        "<TcPlcObject><POU Name=\"P\"><Declaration><![CDATA[PROGRAM P s3cret]]></Declaration></POU></TcPlcObject>",
    )
    .unwrap();
    for path in ["..\\other\\a.TcPOU", secret.to_str().unwrap()] {
        let text = format!("<Project><ItemGroup><Compile Include=\"{path}\" /></ItemGroup></Project>");
        write(at.own.join("p.plcproj"), text).unwrap();
        for words in [
            &["check", "p.plcproj"][..],
            &["check", "."],
            &["test", "p.plcproj"],
            &["instrument", "p.plcproj", "-o", "out"],
        ] {
            let said = typed(&at.own, words);
            let all = said_all(&said);
            assert!(said.code == Some(2) && all.contains("outside of the folder"), "{path} {words:?}: {said:?}");
            assert!(!all.contains(SECRET), "{path} {words:?}: {said:?}");
        }
    }
}

/// The scenario's own file, and what it is based on.
#[test]
fn scenarios() {
    let at = place("version = 1\n");
    write(at.other.join("scenario.toml"), "version = \"s3cret\"\n").unwrap();
    std::fs::remove_file(at.own.join("scenario.toml")).unwrap();
    std::os::unix::fs::symlink(at.other.join("scenario.toml"), at.own.join("scenario.toml")).unwrap();
    for command in ["run", "check", "test", "describe", "wiring"] {
        is_refused_by(&at, &[command, "."]);
    }
}

/// Snapshots are neither read nor written nor removed through a link.
#[test]
fn snapshots() {
    let folder = crate::typed::copied_shear();
    let outside = tempfile::tempdir().unwrap();
    let shelf = folder.path().join("snapshots");
    std::fs::remove_dir_all(&shelf).unwrap();
    std::os::unix::fs::symlink(outside.path(), &shelf).unwrap();
    let pending = outside.path().join("nominal.traj.new");
    write(&pending, SECRET).unwrap();
    for words in [&["test", "."][..], &["review", ".", "--accept-all"], &["review", ".", "--reject-all"]] {
        let said = typed(folder.path(), words);
        assert!(
            said.code != Some(0) && said_all(&said).contains("outside of the scenario's folder"),
            "{words:?}: {said:?}"
        );
        assert!(!said_all(&said).contains(SECRET), "{words:?}: {said:?}");
    }
    let left: Vec<_> = std::fs::read_dir(outside.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["nominal.traj.new"]);
    assert_eq!(std::fs::read_to_string(&pending).unwrap(), SECRET);
}

/// Nor is a folder made behind one: those of a scenario's file of another name have one of their own.
#[test]
fn folders_of_snapshots() {
    let folder = crate::typed::copied_shear();
    let outside = tempfile::tempdir().unwrap();
    let shelf = folder.path().join("snapshots");
    std::fs::remove_dir_all(&shelf).unwrap();
    std::os::unix::fs::symlink(outside.path(), &shelf).unwrap();
    std::fs::copy(folder.path().join("scenario.toml"), folder.path().join("other.toml")).unwrap();
    let said = typed(folder.path(), &["test", "other.toml"]);
    assert!(said.code != Some(0) && said_all(&said).contains("outside of the scenario's folder"), "{said:?}");
    assert_eq!(std::fs::read_dir(outside.path()).unwrap().count(), 0);
}
