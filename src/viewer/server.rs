//! HTTP and WebSocket: the page, and the way between a page and its desk.

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Path, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use tokio::net::TcpListener;
use tokio::time::{Instant, interval, timeout};

use super::desk::{Desk, Outgoing};
use super::studio::Studio;

const PAGE: &str = include_str!("page.html");
/// What the page may do: nothing but what is in it, and its own WebSocket.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src blob: data:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// Bytes of a message from a page at the most.
const MAX_MESSAGE: usize = 16 << 10;
/// A page from which nothing comes for so long, not even an answer to a ping, is gone.
const SILENCE: Duration = Duration::from_secs(30);
const PING: Duration = Duration::from_secs(5);
/// A message that does not get out for so long has nobody to go to.
const STUCK: Duration = Duration::from_secs(30);

/// Who may come in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Access {
    /// What the address must contain.
    pub token: String,
    /// Whether only this machine is served.
    pub loopback: bool,
}

impl Access {
    /// With a token of 128 random bits.
    ///
    /// # Errors
    ///
    /// Where the system has no random bits.
    pub fn new(address: IpAddr) -> Result<Self, getrandom::Error> {
        let mut bits = [0; 16];
        getrandom::fill(&mut bits)?;
        Ok(Self { token: bits.iter().map(|byte| format!("{byte:02x}")).collect(), loopback: address.is_loopback() })
    }

    /// Whether a request may be answered. A name that somebody made resolve to this machine is no host of a loopback server,
    /// and a WebSocket is for the page from the very same host only.
    pub fn permits(&self, token: &str, host: Option<&str>, origin: Option<&str>, websocket: bool) -> bool {
        let same = token.len() == self.token.len()
            && token.bytes().zip(self.token.bytes()).fold(0, |difference, (a, b)| difference | (a ^ b)) == 0;
        let Some(host) = host else { return false };
        let name = host.rsplit_once(':').map_or(host, |(name, port)| if port.ends_with(']') { host } else { name });
        let literal = name.trim_matches(['[', ']']).parse::<IpAddr>().is_ok();
        let known = !self.loopback || literal || name == "localhost";
        let origin_fits = origin.map_or(!websocket, |origin| origin == format!("http://{host}"));
        same && known && origin_fits
    }

    fn permits_request(&self, token: &str, headers: &HeaderMap, websocket: bool) -> bool {
        let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
        self.permits(token, text(header::HOST), text(header::ORIGIN), websocket)
    }
}

/// A server that listens.
#[derive(Debug)]
pub struct Server {
    listener: std::net::TcpListener,
    access: Access,
    address: SocketAddr,
}

#[derive(Debug, Clone)]
struct Shared {
    studio: Arc<Studio>,
    access: Access,
}

impl Server {
    /// Listens at `address`; port 0 is any free one.
    ///
    /// # Errors
    ///
    /// Whatever the system says.
    pub fn bind(address: SocketAddr) -> std::io::Result<Self> {
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let access = Access::new(address.ip()).map_err(std::io::Error::other)?;
        Ok(Self { listener, access, address })
    }

    /// The page's address.
    pub fn url(&self) -> String {
        format!("http://{}/{}/", self.address, self.access.token)
    }

    /// Serves pages for as long as the program runs.
    ///
    /// # Errors
    ///
    /// Whatever the system says.
    pub fn serve(self, studio: Arc<Studio>) -> std::io::Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        runtime.block_on(async {
            let listener = TcpListener::from_std(self.listener)?;
            let shared = Shared { studio, access: self.access };
            let router =
                Router::new().route("/{token}/", get(page)).route("/{token}/ws", get(connect)).with_state(shared);
            axum::serve(listener, router).await
        })
    }
}

async fn page(State(shared): State<Shared>, Path(token): Path<String>, headers: HeaderMap) -> Response {
    if !shared.access.permits_request(&token, &headers, false) {
        return StatusCode::FORBIDDEN.into_response();
    }
    let headers = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ];
    (headers, Html(PAGE)).into_response()
}

async fn connect(
    State(shared): State<Shared>,
    Path(token): Path<String>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !shared.access.permits_request(&token, &headers, true) {
        return StatusCode::FORBIDDEN.into_response();
    }
    let Some(desk) = shared.studio.sit_down() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many pages are open").into_response();
    };
    let seat = Seat { desk, studio: shared.studio };
    upgrade.max_message_size(MAX_MESSAGE).max_frame_size(MAX_MESSAGE).on_upgrade(|socket| converse(socket, seat))
}

/// A desk that is left when the connection ends, however it ends.
struct Seat {
    desk: Arc<Desk>,
    studio: Arc<Studio>,
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.desk.close();
        self.studio.bell.ring();
    }
}

/// Carries messages both ways until the page is gone.
async fn converse(mut socket: WebSocket, seat: Seat) {
    let mut ping = interval(PING);
    let mut heard = Instant::now();
    loop {
        let outgoing = tokio::select! {
            incoming = socket.recv() => {
                let Some(Ok(message)) = incoming else { return };
                heard = Instant::now();
                if let Message::Text(text) = message {
                    // What is no message is of another page than ours.
                    let Ok(message) = serde_json::from_str(&text) else { return };
                    seat.desk.receive(&message);
                    seat.studio.bell.ring();
                }
                continue;
            }
            message = seat.desk.taken() => match message {
                Outgoing::Bytes(bytes) => Message::Binary(bytes.into()),
                Outgoing::Words(words) => Message::Text(words.into()),
            },
            _ = ping.tick() => {
                if heard.elapsed() > SILENCE {
                    return;
                }
                Message::Ping(Vec::new().into())
            }
        };
        if !matches!(timeout(STUCK, socket.send(outgoing)).await, Ok(Ok(()))) {
            return;
        }
    }
}
