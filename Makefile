# The same words as bootstrap.sh, for those who type make. `make lock` needs uv on the PATH.
.PHONY: install run test lock clean

install run test:
	./bootstrap.sh $@

# Exact versions of everything, with hashes, for Python 3.12 and later; no index is named.
lock:
	uv pip compile requirements.in --output-file requirements.lock --quiet \
	    --universal --python-version 3.12 --generate-hashes \
	    --no-emit-index-url --no-emit-find-links --custom-compile-command "make lock"

# All that can be made again, except runs/.
clean:
	rm -rf .venv .python .uv .bootstrap.log build dist *.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis
	find fsi meshes postprocess tests -name __pycache__ -type d -prune -exec rm -rf {} +
