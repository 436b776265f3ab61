//! Files to types: map_server YAML, images, CARMEN maps, label images.
