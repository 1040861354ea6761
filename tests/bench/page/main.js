// Starts the worker; a page that measured itself would also measure its own painting.
const worker = new Worker('worker.js', { type: 'module' });
worker.onerror = (event) => fetch('/failed', { method: 'POST', body: event.message ?? 'the worker did not start' });
