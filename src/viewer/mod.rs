//! A live picture in the browser: a local server, one page, one thread that renders for all pages in turn.
//!
//! What a page asks for is kept in its [`Session`], the newest view in place of all older ones. The [`RenderLoop`] looks there
//! whenever it is that page's turn, and enqueues what it has rendered for the server to send. A session has room for a few
//! messages that the page has not acknowledged; while it is full nothing is rendered for that page, so that a slow
//! connection gets newer pictures and never a queue.
//!
//! Every message to the page has a number, one more than the last; `{"do": "ack", "through": n}` acknowledges all up to n.

mod canvas;
mod command_line;
mod cost_model;
mod effect_cost;
mod messages;
mod patch;
mod pose;
mod preview;
mod render_loop;
mod requests;
mod sample_map;
mod sample_map_cache;
mod scene_file;
mod server;
mod session;
mod session_renderer;
mod view_state;
mod wake_signal;

pub use canvas::Canvas;
pub use effect_cost::EffectTimes;
pub use messages::{Controls, PageMessage, PageState, PickedHit, PickedPixel, PixelTable, SampledPart, SceneSummary};
pub use patch::{PATCH, PICTURE_FILE, Patch, Rectangle};
pub use pose::{FlightScale, Pose};
pub use preview::{PreviewMode, PreviewOptions};
pub use render_loop::{MAX_PAGES, Opener, RenderLoop};
pub use requests::PageRequest;
pub use sample_map::{SAMPLE_COLORS, SAMPLE_MAP, SLOTS, SampleColors, SampleMap};
pub use scene_file::{ReadScene, SceneError, SceneFile, SceneSlot, watch};
pub use server::{Access, Server};
pub use session::{MAX_UNACKNOWLEDGED, Outgoing, Session};
pub use view_state::ViewState;
pub use wake_signal::WakeSignal;
