//! Types to bytes: label images, topology, pictures.
