//! What a browser may ask for, and who answers.

use std::sync::Arc;

use axum::body::Body;
use axum::extract::{ConnectInfo, Path, Request, State, WebSocketUpgrade};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Extension, Router};

use super::entry::{AuthError, Rank};
use super::listener::Visitor;
use super::{Session, bundle, entry, guard, viewer};

/// What a page may load and do: what comes from here, and nothing from outside.
const POLICY: &str = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; connect-src 'self'; \
                      frame-ancestors 'none'; base-uri 'none'; form-action 'self'";
/// The longest message of a page, bytes.
const MESSAGE_MAX: usize = 64 * 1024;
/// The largest picture that a page draws, bytes.
const PICTURE_MAX: usize = 256 * 1024 * 1024;
/// The longest form, bytes.
const FORM_MAX: usize = 4 * 1024;
/// Everything that a browser may ask for.
pub(super) fn router(session: Arc<Session>) -> Router {
    Router::new()
        .route("/api/session", get(structure_of))
        .route("/api/live", get(live))
        .route("/api/panel/{picture}", get(behind_panel))
        .route("/api/picture", post(picture))
        .route("/api/login", post(log_in))
        .fallback(get(|request: Request| async move { asset(request.uri().path()) }))
        .layer(middleware::from_fn_with_state(Arc::clone(&session), guarded))
        .with_state(session)
}

/// Every request passes here: what is foreign is refused, who has no token where one is asked for does not come in, and each
/// answer says what a page may do.
async fn guarded(State(session): State<Arc<Session>>, mut request: Request, next: Next) -> Response {
    let admitted = guard::admit(request.headers(), session.scheme).map(|()| session.entry.admit(request.headers()));
    let is_login = request.uri().path() == "/api/login";
    dressed(match admitted {
        Err(foreign) => (StatusCode::FORBIDDEN, format!("{foreign}\n")).into_response(),
        Ok(Ok(rank)) => {
            request.extensions_mut().insert(rank);
            next.run(request).await
        }
        Ok(Err(_)) if is_login => next.run(request).await,
        Ok(Err(barred @ (AuthError::Client(_) | AuthError::NotTrainers(_)))) => {
            (StatusCode::FORBIDDEN, format!("{barred}\n")).into_response()
        }
        Ok(Err(_)) if request.uri().path() == "/" => {
            (StatusCode::UNAUTHORIZED, Html(entry::form(None))).into_response()
        }
        Ok(Err(barred)) => (StatusCode::UNAUTHORIZED, format!("{barred}\n")).into_response(),
    })
}

/// The same for pages that are served to this machine only.
pub async fn guarded_here(request: Request, next: Next) -> Response {
    dressed(match guard::admit(request.headers(), "http") {
        Ok(()) => next.run(request).await,
        Err(foreign) => (StatusCode::FORBIDDEN, format!("{foreign}\n")).into_response(),
    })
}

/// An answer that says what a page may do.
fn dressed(mut answer: Response) -> Response {
    const PLAIN: [(HeaderName, HeaderValue); 4] = [
        (header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY)),
        (header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")),
        (header::REFERRER_POLICY, HeaderValue::from_static("same-origin")),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
    ];
    answer.headers_mut().extend(PLAIN);
    answer
        .headers_mut()
        .insert(HeaderName::from_static("cross-origin-resource-policy"), HeaderValue::from_static("same-origin"));
    answer
}

async fn structure_of(State(session): State<Arc<Session>>) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], session.structure.clone()).into_response()
}

async fn live(
    State(session): State<Arc<Session>>,
    Extension(rank): Extension<Rank>,
    ConnectInfo(visitor): ConnectInfo<Visitor>,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !visitor.stay() {
        return (StatusCode::SERVICE_UNAVAILABLE, "there are too many viewers\n").into_response();
    }
    upgrade.max_message_size(MESSAGE_MAX).on_upgrade(move |socket| async move {
        viewer::attend(socket, session, rank).await;
        // The place is the viewer's until then.
        drop(visitor);
    })
}

/// A token that somebody has typed.
async fn log_in(State(session): State<Arc<Session>>, body: Body) -> Response {
    let Ok(body) = axum::body::to_bytes(body, FORM_MAX).await else {
        return (StatusCode::PAYLOAD_TOO_LARGE, "a token is shorter\n").into_response();
    };
    // A form without a token has an empty one, which nobody holds.
    match session.entry.log_in(entry::typed(&body).unwrap_or_default()) {
        Ok(cookie) => {
            let to = (header::LOCATION, "/".to_owned());
            (StatusCode::SEE_OTHER, [to, (header::SET_COOKIE, cookie)]).into_response()
        }
        Err(barred) => (StatusCode::UNAUTHORIZED, Html(entry::form(Some(&barred.to_string())))).into_response(),
    }
}

/// The picture behind a panel.
async fn behind_panel(State(session): State<Arc<Session>>, Path(number): Path<String>) -> Response {
    match number.parse().ok().and_then(|number: usize| session.known.pictures.get(number)) {
        Some(picture) => ([(header::CONTENT_TYPE, picture.media)], picture.bytes.clone()).into_response(),
        None => (StatusCode::NOT_FOUND, "no panel has a picture of this number\n").into_response(),
    }
}

/// A picture that the page has drawn: a PNG or, for a film, a WebP; or a text that says why there is none.
async fn picture(State(session): State<Arc<Session>>, headers: HeaderMap, body: Body) -> Response {
    // Before anything of it is read.
    let Some(pictures) = &session.pictures else {
        return (StatusCode::NOT_FOUND, "nobody has asked for a picture\n").into_response();
    };
    let Ok(body) = axum::body::to_bytes(body, PICTURE_MAX).await else {
        return (StatusCode::PAYLOAD_TOO_LARGE, "a picture is smaller\n").into_response();
    };
    let media = headers.get(header::CONTENT_TYPE);
    let is_picture = media.is_some_and(|media| media == "image/png" || media == "image/webp");
    let drawn = if is_picture { Ok(body.to_vec()) } else { Err(String::from_utf8_lossy(&body).into_owned()) };
    match pictures.send(drawn) {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(_) => (StatusCode::GONE, "nobody waits for a picture any more\n").into_response(),
    }
}

/// A file of the page.
pub fn asset(path: &str) -> Response {
    match bundle::file(path) {
        Some((_, media, bytes)) => ([(header::CONTENT_TYPE, media)], bytes).into_response(),
        None if !bundle::is_there() => (StatusCode::NOT_FOUND, format!("{}\n", bundle::ABSENT)).into_response(),
        None => (StatusCode::NOT_FOUND, "there is nothing of this name\n").into_response(),
    }
}
