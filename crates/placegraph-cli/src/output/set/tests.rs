use super::*;

fn set(files: &[(&str, &str)]) -> OutputSet {
    set_with(Existing::Replace, files)
}

fn set_with(existing: Existing, files: &[(&str, &str)]) -> OutputSet {
    let mut set = OutputSet::new(existing);
    for (name, text) in files {
        set.add(*name, *text);
    }
    set
}

fn names(folder: &Path) -> Vec<String> {
    let entry = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(entry).collect();
    names.sort();
    names
}

#[test]
fn files_are_replaced_and_others_stay() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a"), "old").unwrap();
    fs::write(folder.path().join("other"), "mine").unwrap();
    let committed = set(&[("b", "2"), ("a", "1")]).commit(folder.path()).unwrap();
    assert_eq!(committed, Committed { written: vec!["b".into(), "a".into()], removed: Vec::new() });
    assert_eq!(names(folder.path()), ["a", "b", "other"]);
    assert_eq!(fs::read_to_string(folder.path().join("a")).unwrap(), "1");
    assert_eq!(fs::read_to_string(folder.path().join("other")).unwrap(), "mine");
}

#[test]
fn a_missing_folder_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let deep = folder.path().join("x/y");
    set(&[("a", "1")]).commit(&deep).unwrap();
    assert_eq!(names(&deep), ["a"]);
}

#[test]
fn nothing_is_written_if_one_file_cannot_be() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a"), "old").unwrap();
    fs::create_dir(folder.path().join("b")).unwrap();
    let error = set(&[("a", "new"), ("b", "2")]).commit(folder.path()).unwrap_err();
    assert!(format!("{error:#}").contains("a folder of this name exists"), "{error:#}");
    let too_long = "x".repeat(300);
    let error = set(&[("a", "new"), (&too_long, "2")]).commit(folder.path()).unwrap_err();
    assert!(format!("{error:#}").starts_with("cannot write"), "{error:#}");
    assert_eq!(names(folder.path()), ["a", "b"]);
    assert_eq!(fs::read_to_string(folder.path().join("a")).unwrap(), "old");

    let new = folder.path().join("new");
    assert!(set(&[("a", "1"), (&too_long, "2")]).commit(&new).is_err());
    assert!(!new.exists());
}

#[test]
fn folders_that_were_made_for_nothing_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let too_long = "x".repeat(300);
    assert!(set(&[(&too_long, "")]).commit(&folder.path().join("a/b/c")).is_err());
    assert!(names(folder.path()).is_empty());
}

#[test]
fn sets_of_many_threads_are_never_mixed() {
    let folder = tempfile::tempdir().unwrap();
    std::thread::scope(|scope| {
        for writer in 0..8 {
            let path = folder.path();
            scope.spawn(move || {
                let text = writer.to_string();
                set(&[("a", &text), ("b", &text), ("c", &text)]).commit(path).unwrap();
            });
        }
    });
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(names(folder.path()), ["a", "b", "c"]);
    assert!(read("a") == read("b") && read("b") == read("c"));
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    let error = set(&[("a", "1")]).commit(&folder.path().join("file/below")).unwrap_err();
    assert!(format!("{error:#}").contains("file/below"), "{error:#}");
}

#[test]
fn names_are_plain_and_unique() {
    let folder = tempfile::tempdir().unwrap();
    for bad in [&[("../a", "")][..], &[("", "")], &[("a/b", "")], &[("a", ""), ("a", "")]] {
        assert!(set(bad).commit(folder.path()).is_err());
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn files_of_others_are_refused_unless_by_force() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let stamped = "# written by placegraph 0.1.0; map sha256:00\n";
    for (name, text) in
        [("labels.png", "truth"), ("ours.yaml", stamped), ("ours.png", "picture"), ("same", "1")]
    {
        fs::write(path(name), text).unwrap();
    }
    for existing in [Existing::ReplaceOurs, Existing::ReplaceResult] {
        let error = set_with(existing, &[("labels.png", "1")]).commit(folder.path()).unwrap_err();
        assert!(format!("{error:#}").contains("--force"), "{error:#}");
        assert_eq!(fs::read_to_string(path("labels.png")).unwrap(), "truth");
        // By its stamp, by that of the file that it goes with, by its content.
        set_with(existing, &[("ours.yaml", stamped), ("ours.png", "new"), ("same", "1")])
            .commit(folder.path())
            .unwrap();
        assert!(set_with(existing, &[("other.yaml", ""), ("ours.png", "")]).commit(folder.path()).is_err());
    }
    let mut forced = set_with(Existing::ReplaceOurs, &[("labels.png", "1")]);
    forced.keep_inputs(&[path("labels.png")], true);
    forced.commit(folder.path()).unwrap();
    assert_eq!(fs::read_to_string(path("labels.png")).unwrap(), "1");
    // A document of somebody else vouches for nothing.
    fs::write(path("topology.json"), "{\"type\": \"Topology\"}").unwrap();
    assert!(set_with(Existing::ReplaceResult, &[("labels.png", "2")]).commit(folder.path()).is_err());
    assert!(set_with(Existing::ReplaceResult, &[("topology.json", "2")]).commit(folder.path()).is_err());
    // A damaged one of ours still says whose the folder is.
    fs::write(path("topology.json"), "{\n  \"format\": \"placegraph-topology\",\n  \"vers").unwrap();
    set_with(Existing::ReplaceResult, &[("labels.png", "2"), ("topology.json", "{}")])
        .commit(folder.path())
        .unwrap();
}

#[cfg(unix)]
#[test]
fn links_pipes_and_folders_are_refused_even_by_force() {
    use std::os::unix::fs::symlink;

    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("real"), "mine").unwrap();
    symlink("real", path("link")).unwrap();
    fs::create_dir(path("folder")).unwrap();
    let made = std::process::Command::new("mkfifo").arg(path("pipe")).status();
    let mut refused = vec!["link", "folder"];
    refused.extend(made.is_ok_and(|status| status.success()).then_some("pipe"));
    for name in refused {
        let mut set = set(&[(name, "1")]);
        set.keep_inputs(&[], true);
        let error = set.commit(folder.path()).unwrap_err();
        assert!(format!("{error:#}").contains("of this name exists"), "{error:#}");
    }
    assert_eq!(fs::read_to_string(path("real")).unwrap(), "mine");
}
