//! A device that fails, or leaves out work without a word, is found out: between the program and lavapipe stands a driver that does
//! so on demand.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use tempfile::TempDir;

use crate::support::{gpu, root, say_skipped};

const SCENE: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 64 48\nSPHERE a -0.7 0 -4 1 1 1 1 0 0 0.2 0.6 0.4 0.5 40\n\
                     SPHERE b 0.9 0.3 -5 1 1.4 1 0 1 0 0.2 0.6 0.4 0.5 40\nSPHERE floor 0 -11.5 -6 10 10 10 0.5 0.5 1 0.2 0.6 0.2 0.3 10\n\
                     LIGHT l 3 5 0 0.8 0.8 0.8\nBACK 0.2 0.3 0.4\nAMBIENT 0.3 0.3 0.3\nOUTPUT out.ppm\n";

const OLD: &[u8] = b"the picture that was there";

/// The faulty driver of `tests/suite/faulty_driver.c` before lavapipe, with a scene.
pub(crate) struct Driver {
    folder: TempDir,
    /// lavapipe's library.
    inner: String,
    /// The right picture.
    right: Vec<u8>,
}

impl Driver {
    /// None, said aloud, where there is no lavapipe or nothing that compiles C.
    pub(crate) fn new(test: &str) -> Option<Self> {
        drop(gpu(test)?);
        let Some(inner) = lavapipe() else {
            say_skipped(test, "lavapipe is not installed where it usually is");
            return None;
        };
        let folder = tempfile::tempdir().unwrap();
        let library = folder.path().join("driver.so");
        let compile = Command::new("cc")
            .args(["-O1", "-shared", "-fPIC", "-o"])
            .args([&library, &root().join("tests/suite/faulty_driver.c")])
            .arg("-ldl")
            .status();
        if !compile.is_ok_and(|status| status.success()) {
            say_skipped(test, "there is no C compiler");
            return None;
        }
        let manifest = serde_json::json!({
            "file_format_version": "1.0.0",
            "ICD": { "library_path": library, "api_version": "1.3.0" },
        });
        fs::write(folder.path().join("driver.json"), manifest.to_string()).unwrap();
        fs::create_dir(folder.path().join("work")).unwrap();
        fs::write(folder.path().join("work/scene.txt"), SCENE).unwrap();
        let mut driver = Self { folder, inner, right: Vec::new() };
        let (code, stderr, picture) = driver.run("none:0:0", "--verify none");
        assert_eq!(code, Some(0), "{stderr}");
        driver.right = picture;
        Some(driver)
    }

    /// The folder in which the program runs.
    pub(crate) fn work(&self) -> PathBuf {
        self.folder.path().join("work")
    }

    /// The program with a fault.
    pub(crate) fn command(&self, arguments: &str, fault: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
        command
            .args(arguments.split_whitespace())
            .current_dir(self.work())
            .env("VK_DRIVER_FILES", self.folder.path().join("driver.json"))
            .env("INNER", &self.inner)
            .env("FAULT", fault)
            .stdin(Stdio::null());
        command
    }

    /// Renders with a fault: exit code, messages, and the file that was to be replaced.
    fn run(&self, fault: &str, options: &str) -> (Option<i32>, String, Vec<u8>) {
        let work = self.work();
        let picture = work.join("out.ppm");
        fs::write(&picture, OLD).unwrap();
        let output = self
            .command(&format!("render scene.txt -o out.ppm --quiet --device gpu {options}"), fault)
            // What does not answer here never will.
            .env(
                "TRUERAY_PATIENCE",
                if fault.ends_with("drop") && fault.starts_with("vkQueueSubmit") { "1" } else { "120" },
            )
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!stderr.contains("panicked"), "{fault}: {stderr}");
        assert_eq!(fs::read_dir(&work).unwrap().count(), 2, "{fault} leaves a file");
        (output.status.code(), stderr, fs::read(picture).unwrap())
    }

    /// Whether the fault is found out; if not, the picture is right all the same.
    fn is_found_out(&self, fault: &str) -> bool {
        let (code, stderr, picture) = self.run(fault, "");
        match code {
            Some(0) => {
                assert!(picture == self.right, "{fault}: another picture, and no word of it");
                false
            }
            Some(4 | 5) => {
                assert_eq!(picture, OLD, "{fault}: {stderr}");
                assert!(!stderr.is_empty(), "{fault}");
                true
            }
            _ => panic!("{fault}: exit code {code:?}: {stderr}"),
        }
    }
}

/// The library of the software driver, as its file for the loader names it.
fn lavapipe() -> Option<String> {
    let folders = ["/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"];
    let files =
        folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten().map(|entry| entry.path());
    let is_lavapipe = |file: &PathBuf| file.file_name().is_some_and(|name| name.to_string_lossy().starts_with("lvp_"));
    let manifest: serde_json::Value =
        serde_json::from_slice(&fs::read(files.into_iter().find(is_lavapipe)?).ok()?).ok()?;
    let library = manifest["ICD"]["library_path"].as_str()?;
    (Path::new(library).is_absolute() && Path::new(library).exists()).then(|| library.to_owned())
}

/// Calls that fail: out of memory on the host and on the device, and a device that is lost.
#[test]
fn a_call_that_fails_ends_with_a_message() {
    let Some(driver) = Driver::new("a_call_that_fails_ends_with_a_message") else { return };
    for fault in [
        "vkCreateDevice:1:-1",
        "vkCreateBuffer:1:-2",
        "vkCreateBuffer:20:-2",
        "vkAllocateMemory:1:-2",
        "vkBindBufferMemory:9:-2",
        "vkCreateImage:3:-1",
        "vkCreateShaderModule:1:-1",
        "vkCreateComputePipelines:1:-2",
        "vkAllocateDescriptorSets:1:-1",
        "vkBeginCommandBuffer:9:-4",
        "vkQueueSubmit:4:-4",
        "vkWaitSemaphores:2:-4",
        "vkGetSemaphoreCounterValue:3:-4",
    ] {
        assert!(driver.is_found_out(fault), "{fault} has done nothing");
    }
}

/// Commands that a driver drops: some are never missed, but what is missed is found out.
#[test]
fn a_command_that_is_dropped_is_missed() {
    let Some(driver) = Driver::new("a_command_that_is_dropped_is_missed") else { return };
    let found_out = |function: &str, most: u32| -> Vec<u32> {
        (1..=most).filter(|call| driver.is_found_out(&format!("{function}:{call}:drop"))).collect()
    };
    // Of the dispatches the first only makes the driver finish compiling.
    assert_eq!(found_out("vkCmdDispatch", 3), [2]);
    assert_eq!(found_out("vkCmdBindDescriptorSets", 2), [2]);
    assert_eq!(found_out("vkUpdateDescriptorSets", 1), [1]);
    // Tables of the scene, all of which this one needs.
    assert_eq!(found_out("vkCmdCopyBufferToImage", 8).len(), 8);
    assert!(!found_out("vkCmdCopyBuffer", 8).is_empty());
    // Without the reference's pixels nobody would know.
    let (code, _, picture) = driver.run("vkCmdCopyBufferToImage:1:drop", "--verify none");
    assert!(code == Some(0) && picture != driver.right);
}

/// A submission that never comes: the driver waits inside the next one, or what waits for it has a limit.
#[test]
fn a_submission_that_is_dropped_ends_the_run() {
    let Some(driver) = Driver::new("a_submission_that_is_dropped_ends_the_run") else { return };
    for call in [1, 8] {
        let (code, stderr, picture) = driver.run(&format!("vkQueueSubmit:{call}:drop"), "");
        assert!(code == Some(5) && picture == OLD && stderr.contains("sets the limit"), "{call}: {code:?}, {stderr}");
    }
}

#[test]
fn all_pixels_can_be_verified() {
    let Some(driver) = Driver::new("all_pixels_can_be_verified") else { return };
    for options in
        ["--verify all", "--verify 7 --spp 4", "--verify all --precision robust", "--foveate center --verify all"]
    {
        let (code, stderr, picture) = driver.run("none:0:0", options);
        assert_eq!(code, Some(0), "{options}: {stderr}");
        assert!(!picture.is_empty() && picture != OLD);
    }
}
