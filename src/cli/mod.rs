//! The command line: one file for each subcommand.

mod after_help;
mod aov;
mod bench;
mod beside;
mod certificate;
mod check;
mod color;
mod color_bar;
mod compare;
mod conform;
mod devices;
mod environment;
mod export;
mod failure;
mod files;
mod grade;
mod guard;
mod import;
mod input;
mod linear;
mod manual;
mod merge;
mod named;
mod options;
mod output;
mod part;
mod particles;
mod pixel;
mod progress;
mod render;
mod reports;
mod sampling;
mod shader;
mod show;
mod signals;
mod sixel;
mod stats;
mod stress;
mod study;
mod timeline;
mod tune;
mod verify;
mod version;
#[cfg(feature = "view")]
mod view;
mod watchdog;

use std::path::Path;
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use self::failure::Failure;
use crate::{threads, words};

/// Renders scenes of spheres and ellipsoids on any Vulkan device and checks the picture against a CPU reference.
///
/// `trueray SCENE.txt` renders the scene and writes the file that its OUTPUT line names.
#[derive(Debug, Parser)]
#[command(
    name = "trueray",
    version,
    long_version = version::long(),
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    arg_required_else_help = true,
    after_help = after_help::PROGRAM
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    render: render::Args,
    /// Whether messages are coloured
    #[arg(long, value_enum, default_value_t, global = true, value_name = "WHEN", help_heading = "Output")]
    #[allow(dead_code, reason = "read before the rest, for messages about the arguments themselves")]
    color: color::Color,
}

#[derive(Debug, Subcommand)]
#[allow(clippy::large_enum_variant, reason = "there is one of it")]
enum Command {
    /// Render scenes to picture files
    #[command(after_help = after_help::RENDER)]
    Render(render::Args),
    /// Put parts of a picture together that were rendered one by one
    #[command(after_help = after_help::MERGE)]
    Merge(merge::Args),
    /// Say where and how two pictures differ, or a picture and its scene's reference
    #[command(after_help = after_help::COMPARE)]
    Compare(compare::Args),
    /// Score a folder of pictures, those of a class, beside the references of their scenes
    #[command(after_help = after_help::grade())]
    Grade(grade::Args),
    /// Say whether a picture is its scene's in every pixel
    #[command(after_help = after_help::VERIFY)]
    Verify(verify::Args),
    /// Show how one pixel came about: its rays, their tests, light and margins
    #[command(after_help = after_help::PIXEL)]
    Pixel(pixel::Args),
    /// Check scene files and summarise them, without rendering
    #[command(after_help = after_help::CHECK)]
    Check(check::Args),
    /// Measure what accuracy and effects cost in time on a scene
    #[command(after_help = after_help::STUDY)]
    Study(study::Args),
    /// Check on this device what each tier promises of hard cases
    #[command(after_help = after_help::STRESS)]
    Stress(stress::Args),
    /// Check a driver with built-in scenes and hard cases, or compare two
    #[command(after_help = after_help::CONFORM)]
    Conform(conform::Args),
    /// Measure how fast built-in scenes of growing size are rendered
    #[command(after_help = after_help::BENCH)]
    Bench(bench::Args),
    /// Write the particles of another program's file as a scene
    #[command(after_help = after_help::IMPORT)]
    Import(import::Args),
    /// Write a scene for POV-Ray or Tachyon
    #[command(after_help = after_help::EXPORT)]
    Export(export::Args),
    /// Show a scene live in the browser
    #[cfg(feature = "view")]
    #[command(after_help = after_help::VIEW)]
    View(view::Args),
    /// List the Vulkan devices
    #[command(after_help = after_help::DEVICES)]
    Devices(devices::Args),
    /// Print the shader that renders a scene on a device
    #[command(after_help = after_help::SHADER)]
    Shader(shader::Args),
    /// Print a script that completes the command line in a shell
    #[command(after_help = after_help::COMPLETIONS)]
    Completions(manual::CompletionsArgs),
    /// Print the manual page, or that of a command
    #[command(after_help = after_help::MAN)]
    Man(manual::ManArgs),
}

/// Runs the program with the arguments of the process.
pub fn run() -> ExitCode {
    environment::prepare();
    // What is wrong with the arguments is coloured as they ask for, too.
    let (color, arguments) = color::of_arguments(std::env::args_os());
    let matches = Cli::command().color(color.into()).try_get_matches_from(arguments);
    let cli = match matches.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => return say_instead(&error),
    };
    color.choose();
    threads::make_pool();
    if let Err(error) = signals::watch(matches!(cli.command, None | Some(Command::Render(_)))) {
        output::errln!("trueray: signals are not watched, an interrupt may leave temporary files: {error}");
    }
    // These have one code for every trouble.
    let lost = if matches!(cli.command, Some(Command::Compare(_) | Command::Verify(_))) {
        failure::USAGE
    } else {
        failure::DEVICE_LOST
    };
    if let Err(failure) = watchdog::watch(lost) {
        return failure.report().into();
    }
    let ok = |()| failure::OK;
    let ended = match cli.command {
        None => meant_command(cli.render.first_scene()).map_or_else(|| render::run(&cli.render), Err),
        Some(Command::Render(args)) => render::run(&args),
        Some(Command::Merge(args)) => merge::run(&args),
        Some(Command::Compare(args)) => Ok(compare::run(&args)),
        Some(Command::Grade(args)) => grade::run(&args),
        Some(Command::Verify(args)) => Ok(verify::run(&args)),
        Some(Command::Pixel(args)) => pixel::run(&args).map(ok),
        Some(Command::Check(args)) => check::run(&args),
        Some(Command::Study(args)) => study::run(&args).map(ok),
        Some(Command::Stress(args)) => stress::run(&args).map_err(Failure::without_cpu),
        Some(Command::Conform(args)) => conform::run(&args).map_err(Failure::without_cpu),
        Some(Command::Bench(args)) => bench::run(&args),
        Some(Command::Import(args)) => import::run(&args).map(ok),
        Some(Command::Export(args)) => export::run(&args).map(ok),
        #[cfg(feature = "view")]
        Some(Command::View(args)) => view::run(&args).map(ok),
        Some(Command::Devices(args)) => devices::run(&args).map(ok),
        Some(Command::Shader(args)) => shader::run(&args).map(ok).map_err(Failure::without_cpu),
        Some(Command::Completions(args)) => {
            manual::completions(&args, Cli::command());
            Ok(failure::OK)
        }
        Some(Command::Man(args)) => manual::man(&args, Cli::command()).map(ok),
    };
    ended.unwrap_or_else(|failure| failure.report()).into()
}

/// Prints what is asked for in place of a run, as by `--help`, or what is wrong with the arguments.
fn say_instead(said: &clap::Error) -> ExitCode {
    let printed = said.print();
    if !said.use_stderr() {
        output::end_unless(printed);
    }
    u8::try_from(said.exit_code()).unwrap_or(failure::USAGE).into()
}

/// How many letters a mistyped command may be off by.
const SLIPS: usize = 2;

/// The refusal of a first argument that is no file but resembles a command, such as `chek`.
fn meant_command(first: Option<&Path>) -> Option<Failure> {
    let word = first.filter(|path| !path.exists())?.to_str()?;
    let cli = Cli::command();
    let distance = |name: &str| words::slips(word.to_ascii_lowercase().as_bytes(), name);
    let nearest =
        cli.get_subcommands().map(|command| (distance(command.get_name()), command)).min_by_key(|pair| pair.0);
    // Of a short word every other is near.
    let (_, command) = nearest.filter(|&(slips, _)| slips <= SLIPS && 2 * slips < word.len())?;
    let (word, name) = (words::visible(word), command.get_name());
    let message = if word == name {
        format!("options follow the command: write `trueray {name} …`")
    } else {
        format!("there is no file `{word}` and no command of that name; did you mean `{name}`?")
    };
    Some(Failure::new(failure::USAGE, message))
}
