//! A live picture in the browser: a local server, one page, one thread that renders for all pages in turn.
//!
//! What a page wishes is kept on its [`Desk`], the newest wish in place of all older ones; the [`Studio`] looks there
//! whenever it is that page's turn, and lays down what it has painted for the server to send. A desk has room for a few
//! messages that the page has not acknowledged; while it is full nothing is rendered for that page, so that a slow
//! connection gets newer pictures and never a queue.

mod attention;
mod canvas;
mod desk;
mod easel;
mod measure;
mod places;
mod pose;
mod protocol;
mod server;
mod sketch;
mod studio;
mod watch;
mod wishes;

pub use attention::{Attention, Economy};
pub use canvas::Canvas;
pub use desk::{Bell, Desk, MAX_UNACKNOWLEDGED, Outgoing};
pub use places::{PLACES, Places, SAMPLES, SLOTS, SampleColors};
pub use pose::{Pose, Range};
pub use protocol::{FromPage, PATCH, PICTURE_FILE, Patch, Rectangle};
pub use server::{Access, Server};
pub use studio::{MAX_PAGES, Opener, Studio};
pub use watch::{Reading, Stage, Watched, watch};
pub use wishes::Wishes;
