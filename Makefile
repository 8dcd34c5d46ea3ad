# The same words as bootstrap.sh, for those who type make. `make lock` needs uv on the PATH.
.PHONY: install run test site lock clean

install run test:
	./bootstrap.sh $@

# The pages of docs/, the gallery and the Python reference, into site/, without a network; a broken link fails.
site:
	./bootstrap.sh install
	NO_MKDOCS_2_WARNING=1 .venv/bin/mkdocs build --clean

# Exact versions of everything, with hashes, for Python 3.12 and later; no index is named.
lock:
	uv pip compile requirements.in --output-file requirements.lock --quiet \
	    --universal --python-version 3.12 --generate-hashes \
	    --no-emit-index-url --no-emit-find-links --custom-compile-command "make lock"

# All that can be made again, except runs/.
clean:
	rm -rf .venv .python .uv .bootstrap.log build dist site *.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis
	find fsi meshes postprocess tests -name __pycache__ -type d -prune -exec rm -rf {} +
