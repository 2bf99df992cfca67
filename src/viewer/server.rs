//! HTTP and WebSocket: the page, and the way between a page and its session.

use std::collections::VecDeque;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::sync::{Arc, LazyLock};
use std::time::Duration;

use axum::Router;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Path, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use base64::prelude::{BASE64_STANDARD, Engine as _};
use hyper::server::conn::http1;
use hyper_util::rt::TokioIo;
use hyper_util::service::TowerToHyperService;
use sha2::{Digest, Sha256};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::AbortHandle;
use tokio::time::{Instant, interval, sleep, timeout};

use super::render_loop::RenderLoop;
use super::session::{Outgoing, Session};

const PAGE: &str = include_str!("page.html");
/// What the page may do: nothing but what is in it, and its own WebSocket.
static POLICY: LazyLock<String> = LazyLock::new(|| {
    format!(
        "default-src 'none'; script-src 'sha256-{}'; style-src 'unsafe-inline'; img-src blob: data:; \
         connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
        BASE64_STANDARD.encode(Sha256::digest(script().replace("\r\n", "\n")))
    )
});
/// Connections at once whose request is not answered yet, whoever they are from; one more ends the oldest of them.
const MAX_PENDING: usize = 64;
/// So long a request and its answer may take. A WebSocket has limits of its own.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(10);
/// Bytes of the head of a request at the most.
const MAX_HEAD: usize = 16 << 10;
/// Where the system has no room for another connection, one may go meanwhile.
const ACCEPT_RETRY: Duration = Duration::from_millis(50);
/// Bytes of a message from a page at the most.
const MAX_MESSAGE: usize = 16 << 10;
/// A page from which nothing comes for so long, not even an answer to a ping, is gone.
const IDLE_TIMEOUT: Duration = Duration::from_secs(30);
const PING: Duration = Duration::from_secs(5);
/// A message that does not get out for so long has nobody to go to.
const SEND_TIMEOUT: Duration = Duration::from_secs(30);

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
    render_loop: Arc<RenderLoop>,
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
        let host = SocketAddr::new(reachable(self.address.ip()), self.address.port());
        format!("http://{host}/{}/", self.access.token)
    }

    /// Serves pages for as long as the program runs.
    ///
    /// # Errors
    ///
    /// Whatever the system says.
    pub fn serve(self, render_loop: Arc<RenderLoop>) -> std::io::Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        runtime.block_on(async {
            let listener = TcpListener::from_std(self.listener)?;
            let shared = Shared { render_loop, access: self.access };
            let router =
                Router::new().route("/{token}/", get(page)).route("/{token}/ws", get(connect)).with_state(shared);
            accept(listener, router).await;
            Ok(())
        })
    }
}

/// The inline script of the page, the only one that may run.
fn script() -> &'static str {
    let after = PAGE.split_once("<script>").map_or("", |(_, after)| after);
    after.split_once("</script>").map_or("", |(script, _)| script)
}

/// Where a server that listens at `ip` is found: one that listens everywhere at the address that this machine has towards others.
fn reachable(ip: IpAddr) -> IpAddr {
    if !ip.is_unspecified() {
        return ip;
    }
    // Nothing is sent. These addresses belong to nobody: they stand for any.
    let (elsewhere, alone) = match ip {
        IpAddr::V4(_) => ("192.0.2.1:9", IpAddr::V4(Ipv4Addr::LOCALHOST)),
        IpAddr::V6(_) => ("[2001:db8::1]:9", IpAddr::V6(Ipv6Addr::LOCALHOST)),
    };
    let own = || {
        let socket = UdpSocket::bind((ip, 0))?;
        socket.connect(elsewhere)?;
        socket.local_addr()
    };
    own().map(|own| own.ip()).ok().filter(|own| !own.is_unspecified()).unwrap_or(alone)
}

/// Accepts connections, for ever. Strangers can always connect, and neither hold a connection for long nor keep others out.
async fn accept(listener: TcpListener, router: Router) {
    let mut pending: VecDeque<AbortHandle> = VecDeque::new();
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            sleep(ACCEPT_RETRY).await;
            continue;
        };
        pending.retain(|task| !task.is_finished());
        if pending.len() == MAX_PENDING
            && let Some(oldest) = pending.pop_front()
        {
            oldest.abort();
        }
        pending.push_back(tokio::spawn(answer(stream, router.clone())).abort_handle());
    }
}

/// Answers one connection.
async fn answer(stream: TcpStream, router: Router) {
    let service = TowerToHyperService::new(router);
    let mut http = http1::Builder::new();
    http.max_buf_size(MAX_HEAD);
    let connection = http.serve_connection(TokioIo::new(stream), service).with_upgrades();
    // Whoever breaks off or is too slow has had enough.
    let _ = timeout(REQUEST_TIMEOUT, connection).await;
}

async fn page(State(shared): State<Shared>, Path(token): Path<String>, headers: HeaderMap) -> Response {
    if !shared.access.permits_request(&token, &headers, false) {
        return StatusCode::FORBIDDEN.into_response();
    }
    let headers = [
        (header::CONTENT_SECURITY_POLICY, POLICY.as_str()),
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
    let Some(session) = shared.render_loop.connect() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many pages are open").into_response();
    };
    let connection = Connection { session, render_loop: shared.render_loop };
    upgrade.max_message_size(MAX_MESSAGE).max_frame_size(MAX_MESSAGE).on_upgrade(|socket| exchange(socket, connection))
}

/// Closes the session when the connection ends, however it ends.
struct Connection {
    session: Arc<Session>,
    render_loop: Arc<RenderLoop>,
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.session.close();
        self.render_loop.wake.raise();
    }
}

/// Carries messages both ways until the page is gone.
async fn exchange(mut socket: WebSocket, connection: Connection) {
    let mut ping = interval(PING);
    let mut heard = Instant::now();
    loop {
        let outgoing = tokio::select! {
            incoming = socket.recv() => {
                let Some(Ok(message)) = incoming else { return };
                heard = Instant::now();
                if let Message::Text(text) = message {
                    // What is no message is of another page than ours.
                    let Ok(request) = serde_json::from_str(&text) else { return };
                    connection.session.receive(&request);
                    connection.render_loop.wake.raise();
                }
                continue;
            }
            message = connection.session.taken() => match message {
                Outgoing::Bytes(bytes) => Message::Binary(bytes.into()),
                Outgoing::Text(text) => Message::Text(text.into()),
            },
            _ = ping.tick() => {
                if heard.elapsed() > IDLE_TIMEOUT {
                    return;
                }
                Message::Ping(Vec::new().into())
            }
        };
        if !matches!(timeout(SEND_TIMEOUT, socket.send(outgoing)).await, Ok(Ok(()))) {
            return;
        }
    }
}
