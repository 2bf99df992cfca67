//! Whether messages are coloured.

use std::ffi::OsString;
use std::io::IsTerminal;
use std::sync::OnceLock;

use clap::ValueEnum;

/// What `--color` says.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum Color {
    /// On a terminal, unless `NO_COLOR` is set or TERM is `dumb`
    #[default]
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

static CHOICE: OnceLock<Color> = OnceLock::new();

impl Color {
    /// For all messages of this process.
    pub(super) fn choose(self) {
        CHOICE.get_or_init(|| self);
    }
}

impl From<Color> for clap::ColorChoice {
    fn from(color: Color) -> Self {
        match color {
            Color::Auto => Self::Auto,
            Color::Always => Self::Always,
            Color::Never => Self::Never,
        }
    }
}

/// What `--color` says among arguments that may be wrong, and the arguments without those that come before everything else:
/// there they would keep the next word from being a command.
pub(super) fn of_arguments(arguments: impl Iterator<Item = OsString>) -> (Color, Vec<OsString>) {
    let mut arguments = arguments.peekable();
    let mut rest: Vec<OsString> = arguments.next().into_iter().collect();
    let mut color = Color::default();
    while let Some(word) = arguments.next() {
        if word == "--" {
            rest.push(word);
            rest.extend(arguments);
            break;
        }
        let is_alone = word == "--color";
        let value = if is_alone { arguments.peek().and_then(|next| next.to_str()) } else { word.to_str() };
        let value = if is_alone { value } else { value.and_then(|word| word.strip_prefix("--color=")) };
        let chosen = value.and_then(|value| Color::from_str(value, false).ok());
        color = chosen.unwrap_or(color);
        if chosen.is_some() && rest.len() == 1 {
            let _value = arguments.next_if(|_| is_alone);
        } else {
            rest.push(word);
        }
    }
    (color, rest)
}

/// Whether what is written to `stream` is coloured.
pub(super) fn is_on(stream: &impl IsTerminal) -> bool {
    let is_set = |variable| std::env::var_os(variable).is_some_and(|value| !value.is_empty());
    let is_dumb = || std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    match CHOICE.get().copied().unwrap_or_default() {
        Color::Always => true,
        Color::Never => false,
        Color::Auto => stream.is_terminal() && !is_set("NO_COLOR") && !is_dumb(),
    }
}
