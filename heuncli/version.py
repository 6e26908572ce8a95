"""The version of heun, the one place it stands in; read by the build without importing the package."""

VERSION = "0.1.0"
