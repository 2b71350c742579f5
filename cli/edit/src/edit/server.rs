//! The editor's page, served to browsers of this machine by the rules of a session's page.

use std::net::{SocketAddr, TcpListener};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::Router;
use axum::extract::{DefaultBodyLimit, Request, State as Shared};
use axum::http::{StatusCode, header};
use axum::middleware;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::change::Edit;
use super::error::{EditError, EditorError, Reference};
use super::files::{Files, Unwritten};
use super::join::{self, Tip};
use super::state::{self, State};
use super::workspace::Workspace;
use onescan_runner::error::ListenError;
use onescan_runner::how_far::HowFar;
use onescan_runner::web::listener::LimitedListener;
use onescan_runner::web::{asset, guarded_here};

/// The longest request, bytes.
const REQUEST_MAX: usize = 64 * 1024;

/// How much time looking at the files may take at once; behind it, half of the time is left for answers.
const LOOKING_MAX: Duration = Duration::from_millis(500);

/// The files, and what is known of them.
struct EditSession {
    files: Files,
    workspace: Workspace,
    state: State,
    /// Changes that were written.
    how_far: HowFar,
    /// When somebody looked at the files last, and how much of the time went into looking lately.
    looked: (Instant, Duration),
}

/// What a page wants.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "want", rename_all = "lowercase", deny_unknown_fields)]
enum Want {
    /// These changes, together.
    Change { revision: u64, edits: Vec<Edit> },
    /// Two ends connected.
    Join { revision: u64, one: Tip, other: Tip },
    /// An end, or a signal that nobody uses, disconnected.
    Part { revision: u64, tip: Tip },
    /// The last change taken back.
    Undo { revision: u64 },
    /// The same made again.
    Redo { revision: u64 },
    /// The files read again, whatever was done to them.
    Reload,
}

/// Why nothing was done.
#[derive(Debug, Serialize, JsonSchema)]
struct Refusal {
    message: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
    references: Vec<Reference>,
}

/// The answer to what a page wants.
#[derive(Debug, Serialize, JsonSchema)]
struct Answer<'s> {
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<Refusal>,
    #[serde(skip_serializing_if = "Option::is_none")]
    state: Option<&'s State>,
}

/// A refusal with its status.
type Refused = (StatusCode, Refusal);

fn plain(status: StatusCode, message: impl Into<String>) -> Refused {
    (status, Refusal { message: message.into(), file: None, line: None, references: Vec::new() })
}

fn refused(error: &EditError) -> Refused {
    let place = error.place();
    let refusal = Refusal {
        message: error.to_string(),
        file: place.map(|place| place.file.clone()),
        line: place.map(|place| place.line),
        references: error.references().to_vec(),
    };
    (StatusCode::UNPROCESSABLE_ENTITY, refusal)
}

impl From<Unwritten> for Refused {
    fn from(error: Unwritten) -> Self {
        let status = match error {
            Unwritten::Changed(_) => StatusCode::CONFLICT,
            Unwritten::Outside(_) => StatusCode::FORBIDDEN,
            Unwritten::File(_) | Unwritten::Unreadable(_) => StatusCode::INTERNAL_SERVER_ERROR,
        };
        plain(status, error.to_string())
    }
}

impl EditSession {
    fn open(files: Files, how_far: HowFar) -> Result<Self, EditorError> {
        let workspace = Workspace::new(files.read()?, 0);
        let state = state::of(&files, &workspace);
        Ok(Self { files, workspace, state, how_far, looked: (Instant::now(), Duration::ZERO) })
    }

    /// Looks at files, scenes and programs, which may have changed since; not where so many ask that nothing else would be done.
    fn look_again(&mut self) {
        let (at, spent) = self.looked;
        let begun = Instant::now();
        let spent = spent.saturating_sub((begun - at) / 2);
        if spent >= LOOKING_MAX {
            return;
        }
        self.take(self.workspace.clone());
        self.looked = (Instant::now(), spent + begun.elapsed());
    }

    /// Does what is wanted, or nothing.
    fn handle(&mut self, want: Want) -> Result<(), Refused> {
        let mut workspace = self.workspace.clone();
        match want {
            Want::Reload => {
                let texts = self.files.read().map_err(|error| plain(StatusCode::CONFLICT, error.to_string()))?;
                if texts != *workspace.texts() {
                    workspace = Workspace::new(texts, workspace.revision() + 1);
                }
                self.take(workspace);
                return Ok(());
            }
            Want::Change { revision, edits } => {
                self.seen(revision)?;
                workspace.change(&edits).map_err(|error| refused(&error))?;
            }
            Want::Join { revision, one, other } => {
                self.seen(revision)?;
                let edits = join::join(&self.state.ends, &self.state.lines, &one, &other);
                edits.and_then(|edits| workspace.change(&edits)).map_err(|error| refused(&error))?;
            }
            Want::Part { revision, tip } => {
                self.seen(revision)?;
                let edits = join::part(&self.state.ends, &self.state.lines, &tip);
                edits.and_then(|edits| workspace.change(&edits)).map_err(|error| refused(&error))?;
            }
            Want::Undo { revision } => {
                self.seen(revision)?;
                if !workspace.undo() {
                    return Err(plain(StatusCode::UNPROCESSABLE_ENTITY, "there is nothing to take back"));
                }
            }
            Want::Redo { revision } => {
                self.seen(revision)?;
                if !workspace.redo() {
                    return Err(plain(StatusCode::UNPROCESSABLE_ENTITY, "there is nothing to do again"));
                }
            }
        }
        self.files.write(self.workspace.texts(), workspace.texts())?;
        self.how_far.one_more();
        self.take(workspace);
        Ok(())
    }

    fn take(&mut self, workspace: Workspace) {
        self.workspace = workspace;
        self.state = state::of(&self.files, &self.workspace);
    }

    /// Somebody who has not seen the last change does not change anything.
    fn seen(&self, revision: u64) -> Result<(), Refused> {
        if revision == self.workspace.revision() {
            return Ok(());
        }
        Err(plain(StatusCode::CONFLICT, "another page has changed the files: this page shows them now; try again"))
    }
}

type Held = Arc<Mutex<EditSession>>;

/// A listener and what it serves; [`Editor::serve`] does so until the program ends.
pub(super) struct Editor {
    listener: TcpListener,
    address: SocketAddr,
    router: Router,
}

impl Editor {
    /// Opens the files and the address.
    pub(super) fn open(files: Files, address: SocketAddr, how_far: HowFar) -> Result<Self, EditorError> {
        let listen = ListenError::on(address);
        let held: Held = Arc::new(Mutex::new(EditSession::open(files, how_far)?));
        let listener = TcpListener::bind(address).map_err(&listen)?;
        listener.set_nonblocking(true).map_err(&listen)?;
        let address = listener.local_addr().map_err(&listen)?;
        let router = Router::new()
            .route("/api/edit", get(look).post(handle))
            .route("/api/library", get(library))
            .fallback(get(file))
            .layer(DefaultBodyLimit::max(REQUEST_MAX))
            .layer(middleware::from_fn(guarded_here))
            .with_state(held);
        Ok(Self { listener, address, router })
    }

    /// Where a browser finds it.
    pub(super) fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Serves until the program is ended.
    pub(super) fn serve(self) -> Result<(), EditorError> {
        let listen = ListenError::on(self.address);
        let runtime = onescan_server::transport::runtime::of_this_thread().map_err(&listen)?;
        let served = async {
            let listener = tokio::net::TcpListener::from_std(self.listener)?;
            axum::serve(LimitedListener::new(listener, None)?, self.router).await
        };
        Ok(runtime.block_on(served).map_err(listen)?)
    }
}

fn answer(status: StatusCode, body: &impl Serialize) -> Response {
    match serde_json::to_string(body) {
        Ok(text) => (status, [(header::CONTENT_TYPE, "application/json")], text).into_response(),
        Err(error) => (StatusCode::INTERNAL_SERVER_ERROR, format!("{error}\n")).into_response(),
    }
}

async fn look(Shared(held): Shared<Held>) -> Response {
    let mut edit_session = held.lock().unwrap_or_else(PoisonError::into_inner);
    edit_session.look_again();
    answer(StatusCode::OK, &edit_session.state)
}

async fn handle(Shared(held): Shared<Held>, body: String) -> Response {
    let want: Want = match serde_json::from_str(&body) {
        Ok(want) => want,
        Err(error) => {
            let (status, refusal) = plain(StatusCode::BAD_REQUEST, format!("not a request of the page: {error}"));
            return answer(status, &Answer { error: Some(refusal), state: None });
        }
    };
    let mut edit_session = held.lock().unwrap_or_else(PoisonError::into_inner);
    match edit_session.handle(want) {
        Ok(()) => answer(StatusCode::OK, &Answer { error: None, state: Some(&edit_session.state) }),
        Err((status, refusal)) => {
            let changed = edit_session.files.changed(edit_session.workspace.texts());
            edit_session.state.changed = changed;
            answer(status, &Answer { error: Some(refusal), state: Some(&edit_session.state) })
        }
    }
}

async fn library() -> Response {
    answer(StatusCode::OK, &state::library())
}

/// The files of the page; the first of them is the editor's own.
async fn file(request: Request) -> Response {
    let path = request.uri().path();
    asset(if path == "/" { "/edit.html" } else { path })
}

#[cfg(test)]
mod tests {
    use onescan_page_types::Types;
    use onescan_page_types::published::{is_published, is_published_in};

    use super::*;

    #[test]
    fn the_page_has_the_types_of_this_server() {
        let types = Types::default().receive::<State>().receive::<Answer>().receive::<state::Library>().send::<Want>();
        is_published("src/generated/edit.ts", &types.module(state::PROTOCOL));
        is_published_in("PROTOCOL.md", "wants", &types.table("Want"));
        is_published_in("PROTOCOL.md", "edits", &types.table("Edit"));
    }
}
