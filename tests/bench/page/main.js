// Starts the worker, because the page's own painting must not be measured.
const worker = new Worker('worker.js', { type: 'module' });
worker.onerror = (event) => fetch('/failed', { method: 'POST', body: event.message ?? 'the worker did not start' });
