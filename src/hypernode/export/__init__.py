"""An identified material as files that other programs read: opened datasets in, the content of files out."""
