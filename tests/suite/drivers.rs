//! Which drivers are not even loaded, and that no device is lost by it.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use trueray::gpu::{drivers, kernel_cache};

use crate::support::gpu;

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
    let Some(gpu) = gpu("compiled_kernels_are_kept_and_a_damaged_file_is_told_and_replaced") else {
        return;
    };
    let (index, grows) = (gpu.device.info.index, gpu.device.info.driver.contains("SwiftShader"));
    drop(gpu);
    let folder = tempfile::tempdir().unwrap();
    let scene =
        "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 16 8\nSPHERE s 0 0 -5 2 2 2 1 0 0 1 0 0 0 1\nAMBIENT 1 1 1\n";
    std::fs::write(folder.path().join("scene.txt"), scene).unwrap();
    let run = |switch: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
        command.args(["render", "scene.txt", "-v", "-o", "out.ppm", "--device", &index.to_string()]);
        command.current_dir(folder.path()).env("XDG_CACHE_HOME", folder.path()).env(kernel_cache::SWITCH, switch);
        command.env("MESA_SHADER_CACHE_DIR", crate::support::driver_cache());
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
    // SwiftShader's grows at each run.
    assert_eq!(std::fs::read(file).unwrap() != kept, grows);

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

/// Whatever keeps a driver from being there is named, and the file in question with it.
#[test]
fn what_fails_on_the_way_to_a_device_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let manifest = file(
        "missing.json",
        r#"{"file_format_version":"1.0.0","ICD":{"library_path":"/nowhere/lib-of-no-driver.so","api_version":"1.3.0"}}"#,
    );
    let torn = file("torn.json", "{");
    let nowhere = folder.path().join("nowhere.json");
    for (manifest, part) in [(&manifest, "lib-of-no-driver.so"), (&torn, "torn.json"), (&nowhere, "nowhere.json")] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
        command.arg("devices").env("VK_DRIVER_FILES", manifest).env("VK_ICD_FILENAMES", manifest);
        let output = command.output().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(4), "{errors}");
        assert!(errors.contains(part) && errors.contains("--device cpu"), "{errors}");
    }
    // A loader that is not one.
    if cfg!(target_os = "linux") {
        file("libvulkan.so.1", "no library");
        let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
        let output = command.arg("devices").env("LD_LIBRARY_PATH", folder.path()).output().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(4), "{errors}");
        assert!(errors.contains("the Vulkan loader cannot be loaded") && errors.contains("libvulkan.so.1"), "{errors}");
        assert!(!errors.contains("no Vulkan device was found"), "{errors}");
    }
}

#[test]
fn the_hint_fits_the_system() {
    for (text, part) in [
        ("PRETTY_NAME=\"Debian GNU/Linux 12\"\nID=debian\n", "apt install mesa-vulkan-drivers"),
        ("ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n", "apt install"),
        ("ID=fedora", "dnf install mesa-vulkan-drivers"),
        ("ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"\n", "dnf install"),
        ("NAME=Arch\nID=arch\n", "pacman -S vulkan-swrast"),
        ("ID='alpine'\nVERSION_ID=3.20\n", "apk add mesa-vulkan-swrast"),
        ("ID=plan9\n", "lavapipe"),
        ("", "lavapipe"),
    ] {
        assert!(drivers::hint_for(text).contains(part), "{text}: {}", drivers::hint_for(text));
    }
}

/// Mesa's layer is left out unless one of its variables is set; then it does what they say, here to list its devices.
#[test]
fn a_device_that_is_chosen_by_mesas_variables_is_obeyed() {
    let chosen = |variables: &[&str]| drivers::is_device_chosen(variables.iter().map(OsString::from));
    for variable in ["MESA_VK_DEVICE_SELECT", "MESA_VK_DEVICE_SELECT_FORCE_DEFAULT_DEVICE", "DRI_PRIME"] {
        assert!(chosen(&["PATH", variable]), "{variable}");
    }
    assert!(!chosen(&["PATH", "NODEVICE_SELECT", "MESA_LOADER_DRIVER_OVERRIDE"]));

    let layer = "/usr/share/vulkan/implicit_layer.d/VkLayer_MESA_device_select.json";
    let test = "a_device_that_is_chosen_by_mesas_variables_is_obeyed";
    if gpu(test).is_none() || !Path::new(layer).exists() {
        return crate::support::say_skipped(test, "no device, or Mesa's layer is not there");
    }
    let list = |choose: bool| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
        command.arg("devices").env_remove(drivers::NO_CHOOSER).env_remove("DRI_PRIME");
        let command = if choose { command.env("MESA_VK_DEVICE_SELECT", "list") } else { &mut command };
        String::from_utf8(command.output().unwrap().stderr).unwrap()
    };
    assert!(list(true).contains("selectable devices"));
    assert!(!list(false).contains("selectable devices"));
}

/// What a report of a fault has to tell of a device and its driver.
#[test]
fn a_device_tells_what_vulkan_says_of_it() {
    if gpu("a_device_tells_what_vulkan_says_of_it").is_none() {
        return;
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
    let output = command.args(["devices", "--json"]).output().unwrap();
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for device in all.as_array().unwrap().iter().filter(|device| device.get("index").is_some()) {
        let vulkan = &device["vulkan"];
        let text = |pointer: &str| vulkan.pointer(pointer).and_then(|it| it.as_str()).unwrap_or_default().to_owned();
        assert!(text("/api_version").split('.').count() == 3, "{vulkan}");
        assert!(["/vendor_id", "/device_id"].iter().all(|id| text(id).starts_with("0x")), "{vulkan}");
        if text("/api_version").as_str() >= "1.2" {
            assert_eq!(text("/driver/conformance_version").split('.').count(), 4, "{vulkan}");
            assert!(["/ids/device_uuid", "/ids/driver_uuid"].iter().all(|id| text(id).len() == 32), "{vulkan}");
            // wgpu knows the driver by the same words.
            let driver = format!("{} {}", text("/driver/name"), text("/driver/info"));
            assert_eq!(device["driver"], driver.trim(), "{vulkan}");
            let widths = vulkan["float_controls"]["signed_zero_inf_nan_preserve"].as_array().unwrap();
            assert!(widths.iter().all(|width| [16, 32, 64].iter().any(|it| width == it)), "{vulkan}");
        }
        let has_f64 = vulkan["scalars"].as_array().unwrap().iter().any(|scalar| scalar == "f64");
        assert!(has_f64 || device["f64"] == false, "{vulkan}");
        let most = vulkan["limits"]["max_compute_work_group_invocations"].as_u64().unwrap();
        assert!(most >= device["max_invocations"].as_u64().unwrap(), "{vulkan}");
    }
}
