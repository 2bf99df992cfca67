//! Which drivers are not even loaded, and that no device is lost by it.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use trueray::gpu::{drivers, kernel_cache};

fn idle(devices: &Path, variables: &[&str]) -> Option<&'static str> {
    drivers::idle_without(devices, variables.iter().map(OsString::from))
}

#[test]
fn drivers_are_left_out_only_where_there_is_surely_no_device_and_nobody_chose() {
    let folder = tempfile::tempdir().unwrap();
    let (empty, missing) = (folder.path(), folder.path().join("none"));
    for devices in [empty, &missing] {
        assert!(idle(devices, &["PATH", "HOME", "NODEVICE_SELECT"]).is_some());
        for choice in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES", drivers::SWITCH, "LD_PRELOAD"] {
            assert_eq!(idle(devices, &["PATH", choice]), None, "{choice}");
        }
        assert_eq!(idle(devices, &["RADV_FORCE_FAMILY"]), None);
    }
    std::fs::write(empty.join("renderD128"), "").unwrap();
    assert_eq!(idle(empty, &["PATH"]), None);
    // What is no folder cannot be read as one.
    assert_eq!(idle(&empty.join("renderD128"), &[]), None);
}

#[test]
fn the_same_devices_are_listed_with_all_drivers_loaded() {
    let list = |all: bool| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
        command.args(["devices", "--json"]);
        if all {
            command.env(drivers::SWITCH, "none-of-these");
        }
        let output = command.output().unwrap();
        (String::from_utf8(output.stdout).unwrap(), output.status.code())
    };
    assert_eq!(list(false), list(true));
}

/// On a software device the cache of compiled kernels has to be asked for; it then behaves as on any other.
#[test]
fn compiled_kernels_are_kept_and_a_damaged_file_is_told_and_replaced() {
    let Some(gpu) = crate::support::gpu("compiled_kernels_are_kept_and_a_damaged_file_is_told_and_replaced") else {
        return;
    };
    let index = gpu.info.index;
    drop(gpu);
    let folder = tempfile::tempdir().unwrap();
    let scene =
        "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 16 8\nSPHERE s 0 0 -5 2 2 2 1 0 0 1 0 0 0 1\nAMBIENT 1 1 1\n";
    std::fs::write(folder.path().join("scene.txt"), scene).unwrap();
    let run = |switch: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
        command.args(["render", "scene.txt", "-v", "-o", "out.ppm", "--device", &index.to_string()]);
        command.current_dir(folder.path()).env("XDG_CACHE_HOME", folder.path()).env(kernel_cache::SWITCH, switch);
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        (std::fs::read(folder.path().join("out.ppm")).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let files = || {
        let entries = std::fs::read_dir(folder.path().join("trueray")).into_iter().flatten();
        let paths = entries.map(|entry| entry.unwrap().path());
        paths.filter(|path| path.to_string_lossy().contains("kernels-")).collect::<Vec<_>>()
    };
    let (expected, _) = run("0");
    assert_eq!(files(), Vec::<std::path::PathBuf>::new());
    let (picture, errors) = run("1");
    assert!(picture == expected && !errors.contains("are not used"), "{errors}");
    let [file] = &files()[..] else { panic!("{:?}", files()) };
    let kept = std::fs::read(file).unwrap();
    let (picture, errors) = run("1");
    assert!(picture == expected && !errors.contains("are not used"), "{errors}");
    assert_eq!(std::fs::read(file).unwrap(), kept);

    let mut damaged = kept.clone();
    *damaged.last_mut().unwrap() ^= 1;
    for contents in [&damaged[..], b"", b"short", &kept[..kept.len() - 1]] {
        std::fs::write(file, contents).unwrap();
        let (picture, errors) = run("0");
        assert!(picture == expected && !errors.contains("are not used"), "{errors}");
        let (picture, errors) = run("1");
        assert!(picture == expected && errors.contains("are not used"), "{errors}");
        assert!(errors.contains(&file.display().to_string()), "{errors}");
        assert_eq!(std::fs::read(file).unwrap(), kept);
    }
}
