//! placegraph in the browser: the library as WebAssembly behind a small C interface, and the page around it.
//!
//! | module | what it holds |
//! |---|---|
//! | `interface` | four functions that the page's worker thread calls; compiled for WebAssembly only |
//! | [`message`] | a request or an answer: JSON and byte strings in one block of memory |
//! | [`session`] | the open map, and what can be asked of it: the same library calls as the program makes |
//! | `teach` | painted maps as a training file, and the model that comes of them |
//! | [`page`] | one HTML file of the page's modules, the viewer and the library |

#[cfg(target_arch = "wasm32")]
mod interface;
pub mod message;
#[cfg(not(target_arch = "wasm32"))]
pub mod page;
mod result;
pub mod session;
mod teach;
