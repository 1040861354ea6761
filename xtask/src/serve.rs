//! The local server: serves one folder on 127.0.0.1 with the headers of its `_headers` file, like a static host.

use std::io::ErrorKind;
use std::net::{Ipv4Addr, TcpListener};
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Result, bail};
use axum::Router;
use axum::extract::{Request, State};
use axum::http::StatusCode;
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use tower_http::services::ServeDir;

use crate::files;
use crate::headers::{FILE, Headers};

pub(crate) fn bind(port: u16) -> Result<TcpListener> {
    match TcpListener::bind((Ipv4Addr::LOCALHOST, port)) {
        Ok(listener) => Ok(listener),
        Err(error) if error.kind() == ErrorKind::AddrInUse => bail!(
            "port {port} on 127.0.0.1 is in use; use another with --port N, or any free one with --port 0"
        ),
        Err(error) => Err(error).with_context(|| format!("port {port} on 127.0.0.1 can't be opened")),
    }
}

pub(crate) async fn serve(listener: TcpListener, web: &Path, open: bool) -> Result<()> {
    let file = web.join(FILE);
    let text = files::read(&file)?;
    let router = router(web, Headers::parse(&text)?);
    let address = format!("http://{}/", listener.local_addr()?);
    listener.set_nonblocking(true)?;
    let listener = tokio::net::TcpListener::from_std(listener)?;
    println!("serving {address}\n(Ctrl-C stops it)");
    if open
        && has_desktop()
        && let Err(error) = open::that_detached(&address)
    {
        eprintln!("the browser could not be opened ({error}); open {address} yourself");
    }
    axum::serve(listener, router).await.context("the server stopped")
}

fn has_desktop() -> bool {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")
}

fn router(web: &Path, headers: Headers) -> Router {
    Router::new()
        .fallback_service(ServeDir::new(web))
        .layer(from_fn_with_state(Arc::new(headers), add_headers))
}

async fn add_headers(State(headers): State<Arc<Headers>>, request: Request, next: Next) -> Response {
    let path = request.uri().path().to_owned();
    let mut response = if path.strip_prefix('/') == Some(FILE) {
        StatusCode::NOT_FOUND.into_response()
    } else {
        next.run(request).await
    };
    for (name, value) in headers.of(&path) {
        response.headers_mut().append(name, value.clone());
    }
    response
}

#[cfg(test)]
mod tests {
    use axum::body::Body;
    use axum::http::header::CONTENT_TYPE;
    use tower::ServiceExt;

    use super::*;

    #[test]
    fn a_port_in_use_is_reported_with_the_remedy() {
        let first = bind(0).unwrap();
        let port = first.local_addr().unwrap().port();
        assert_eq!(
            bind(port).unwrap_err().to_string(),
            format!(
                "port {port} on 127.0.0.1 is in use; use another with --port N, or any free one with --port 0"
            )
        );
    }

    #[tokio::test]
    async fn every_response_has_its_type_and_the_headers_of_its_path() {
        let web = std::env::temp_dir().join(format!("stepscope-serve-{}", std::process::id()));
        std::fs::create_dir_all(web.join("pkg")).unwrap();
        for name in ["index.html", "app.js", "page.css", "pkg/a.wasm", "app.webmanifest", "_headers"] {
            std::fs::write(web.join(name), "").unwrap();
        }
        let router = router(&web, Headers::parse("/*\n  X-All: 1\n/pkg/*\n  X-Pkg: 2\n").unwrap());
        for (path, status, kind, in_pkg) in [
            ("/", 200, "text/html", false),
            ("/app.js", 200, "text/javascript", false),
            ("/page.css", 200, "text/css", false),
            ("/pkg/a.wasm", 200, "application/wasm", true),
            ("/app.webmanifest", 200, "application/manifest+json", false),
            ("/none", 404, "", false),
            ("/_headers", 404, "", false),
            ("/../Cargo.toml", 404, "", false),
            ("/%2e%2e/Cargo.toml", 404, "", false),
        ] {
            let request = Request::get(path).body(Body::empty()).unwrap();
            let response = router.clone().oneshot(request).await.unwrap();
            assert_eq!(response.status().as_u16(), status, "{path}");
            let given = response.headers().get(CONTENT_TYPE).map_or("", |value| value.to_str().unwrap());
            assert_eq!(given, kind, "{path}");
            assert_eq!(response.headers()["x-all"], "1", "{path}");
            assert_eq!(response.headers().contains_key("x-pkg"), in_pkg, "{path}");
        }
        std::fs::remove_dir_all(&web).unwrap();
    }
}
