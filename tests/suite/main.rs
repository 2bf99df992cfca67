//! All integration tests in one binary, so that they share one device.
//!
//! Tests that need a Vulkan device say `skipped: no Vulkan device` where there is none; with `TRUERAY_REQUIRE_GPU=1` that is
//! a failure. The official pictures are looked for in the folder that `TRUERAY_KEYS` names.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "the test harness shows it where a test fails")]
#![allow(missing_docs, reason = "test names say what they test")]

mod aov;
mod bench;
mod bound;
mod camera;
mod causes;
mod certified;
mod claims;
mod cli;
mod color_bar;
mod compare;
mod conform;
mod coverage;
mod deep;
mod documents;
mod doubts;
mod drivers;
mod effects;
mod explain;
mod export;
mod files;
mod film;
mod fuzz;
mod golden;
mod grade;
mod heads;
mod house;
mod import;
mod keys;
mod library;
mod linear;
mod lists;
mod magnitudes;
mod masked;
mod messages;
mod missed;
mod misuse;
mod oracle;
#[cfg(feature = "view")]
mod page;
mod parse;
mod parts;
mod pattern;
mod phong;
mod pictures;
mod pixel;
#[cfg(feature = "view")]
mod preview;
mod projection;
mod proof;
mod rays;
mod refraction;
mod report;
mod sampling;
mod shaders;
mod stress;
mod study;
mod support;
mod tangents;
mod tuning;
mod twins;
mod verify;
#[cfg(feature = "view")]
mod view;
mod views;
mod wide;
